"""Motions of the machine at constant speed, and analyses of them: statistics, periods, chaos, maps."""
