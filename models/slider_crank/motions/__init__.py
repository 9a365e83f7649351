"""Motions of the slider-crank at constant speed, and their analysis: statistics, periods, chaos, maps."""
