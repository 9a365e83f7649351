"""Small oscillators with exact solutions, to measure coupling errors."""
