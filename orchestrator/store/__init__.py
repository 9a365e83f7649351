"""Files of a run: journals while it goes on, and results."""
