"""Lubricated line contact: Hertz deflection, film formulas, friction estimate."""
