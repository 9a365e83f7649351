"""Participants of a co-simulation behind one protocol: components, and FMUs in this process or their own.

Import what you need from its file: an FMU's own process imports this package without components and compiler.
"""
