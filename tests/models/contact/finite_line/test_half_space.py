"""Deflection of the half-space: closed forms and the sum that the transforms stand for."""

from __future__ import annotations

import math

import numpy as np
import pytest

from models.contact.finite_line.grid import Grid, Resolution, axial_faces, even_nodes
from models.contact.finite_line.half_space import HalfSpace, corner

GRID = Grid(even_nodes(-1.0, 1.2, 0.2), axial_faces(6.0, 1.0, (2.0,), Resolution(5, 0.3, 0.4, 6)))


def test_a_square_under_even_pressure():
    """Love: the integral of 1/r over a square of side 2 seen from its middle is 8 ln(1 + sqrt 2)."""
    assert 4.0 * corner(1.0, 1.0) == pytest.approx(8.0 * math.log(1.0 + math.sqrt(2.0)), rel=1e-15)


def test_the_transform_is_the_sum_over_all_cells():
    """Each cell by its four corners, summed one by one."""
    x, y, faces, d = GRID.x, GRID.y, GRID.faces, GRID.spacing
    p = np.random.default_rng(1).random(GRID.shape)
    summed = np.zeros(GRID.shape)
    for i, j in np.ndindex(GRID.shape):
        for k, l in np.ndindex(GRID.shape):
            xs = (x[k] - 0.5 * d - x[i], x[k] + 0.5 * d - x[i])
            ys = (faces[l] - y[j], faces[l + 1] - y[j])
            cell = corner(xs[1], ys[1]) - corner(xs[0], ys[1]) - corner(xs[1], ys[0]) + corner(xs[0], ys[0])
            summed[i, j] += cell * p[k, l]
    # Rounding of transforms of 11 nodes.
    np.testing.assert_allclose(HalfSpace(GRID, 1.0).deflection(p), summed, rtol=1e-12)


def test_a_load_far_away_is_a_point():
    """w = W/r, with the next term of the order (size/r)^2."""
    grid = Grid(even_nodes(-20.0, 20.0, 0.5), np.linspace(-0.5, 0.5, 5))
    p = np.zeros(grid.shape)
    p[0] = 1.0
    assert HalfSpace(grid, 1.0).deflection(p)[-1, 1] == pytest.approx(0.5 / 40.0, rel=(0.5 / 40.0) ** 2)


def test_faces_lie_on_ends_kinks_and_middle():
    for mark in (-3.0, -2.0, 0.0, 2.0, 3.0):
        assert np.abs(GRID.faces - mark).min() < 1e-12
    np.testing.assert_array_equal(GRID.faces, -GRID.faces[::-1])
