"""Files of a run: journals during the run, and results."""
