"""Lubricated finite line contact in two dimensions: steady film, pressure and deformation with its ends.

A roller or tappet of length L with an axial profile (`profiles`) and a misalignment, on a half-space
(`half_space`); Reynolds' equation with cavitation (`reynolds`), solved for a load or an approach (`steady`),
without a film (`dry`), and instant by instant through a cam cycle (`cycle`).
"""
