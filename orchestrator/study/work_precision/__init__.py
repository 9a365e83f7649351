"""Work-precision diagrams: error over doStep calls and time, of the masters here and of other tools.

`benchmark.benchmark` runs it.
"""
