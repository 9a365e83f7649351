"""Slider-crank with clearance at the slider (Farahanchi 1991)."""
