"""Fits parameters of a scenario to measured signals."""
