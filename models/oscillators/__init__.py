"""Small oscillators, whose exact solutions the tests have, to measure coupling errors."""
