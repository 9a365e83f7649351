"""tribocosim: scenarios, co-simulation masters, results and the command line."""
