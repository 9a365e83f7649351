"""Scenarios, co-simulation masters, results and analyses."""

from tribocosim.packages import find_shadowed

if message := find_shadowed():
    raise ImportError(message)
