"""tribocosim: scenarios, co-simulation masters, results and the command line."""

from tribocosim.packages import hidden

if message := hidden():
    raise ImportError(message)
