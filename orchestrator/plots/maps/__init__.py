"""Figures of many motions: maps, bifurcation diagrams, basins, transients."""
