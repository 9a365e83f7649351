"""Scenarios, co-simulation masters, results and analyses."""
