"""Figures of many slider-crank motions: maps, bifurcation diagrams, basins, transients."""
