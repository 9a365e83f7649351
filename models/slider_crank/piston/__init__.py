"""Slider-crank with a rectangular piston that has clearance in its bore and can tilt."""
