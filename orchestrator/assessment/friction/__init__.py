"""Friction and wear over a cam revolution, from the result of a run."""
