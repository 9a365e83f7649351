"""A run, from the scenario to its files."""
