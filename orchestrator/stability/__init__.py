"""Before the run: how each master, signal and order would behave on a scenario, from its linearisation."""
