"""Small oscillators with exact solutions, for measuring what a coupling does."""
