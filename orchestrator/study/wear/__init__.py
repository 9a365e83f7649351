"""Wear of a cam over millions of cycles: its worn profile goes back into the steady cycle."""
