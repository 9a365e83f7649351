"""tribocosim: scenarios, co-simulation masters, results and the command line."""

from tribocosim.packages import find_shadowed

if message := find_shadowed():
    raise ImportError(message)
