"""Stability and errors of every master, signal and order on a scenario, predicted from its linearisation."""
