"""Deflection of the half-space: closed forms and the sum that the transforms stand for."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from models.contact.analysis.finite_line.grid import (
    Edges,
    Grid,
    Resolution,
    axial_faces,
    even_nodes,
    graded_nodes,
)
from models.contact.analysis.finite_line.half_space import HalfSpace, corner, fill_near

GRID = Grid(even_nodes(-1.0, 1.2, 0.2), axial_faces(6.0, 1.0, (2.0,), Resolution(5, 0.3, 0.4, 6)))


def test_a_square_under_even_pressure():
    """Love: the integral of 1/r over a square of side 2 seen from its middle is 8 ln(1 + sqrt 2)."""
    assert 4.0 * corner(1.0, 1.0) == pytest.approx(8.0 * math.log(1.0 + math.sqrt(2.0)), rel=1e-15)


def summed(grid, p, i, j):
    """Deflection at node i of line j: quadrature over every step of x, closed form over every line in y."""
    total, x, y = 0.0, grid.x, grid.y[j]
    for l, (low, high) in enumerate(zip(grid.faces[:-1] - y, grid.faces[1:] - y, strict=True)):

        def under(s, l=l, low=low, high=high):
            away = abs(s - x[i])
            return np.interp(s, x, p[:, l]) * (math.asinh(high / away) - math.asinh(low / away))

        for left, right in pairwise(x):
            total += quad(under, left, right, epsabs=1e-11)[0]
    return total


@pytest.mark.parametrize(("i", "j"), [(0, 0), (5, 1), (11, 11)])
def test_near_and_far_parts_are_the_integral(i, j):
    """Even nodes and nodes that crowd at an edge: cubics on the mesh err by 4e-4 of a far line's share."""
    for x in (GRID.x, np.sort(np.append(GRID.x[1:-1], [-0.83, -0.81]))):
        grid = Grid(x, GRID.faces)
        p = np.random.default_rng(1).random(grid.shape)
        assert HalfSpace(grid, 1.0).deflection(p)[i, j] == pytest.approx(summed(grid, p, i, j), rel=4e-4)


def test_a_smooth_pressure_on_the_grid_of_a_film():
    """The far part, by the mesh, against all lines in closed form."""
    x = graded_nodes(-2.0, 1.4, Edges(1.0, 1.0, 0.04), Resolution(12.0, nodes_per_inlet=4.0))
    grid = Grid(x, axial_faces(20.0, 1.0, (), Resolution(12.0, 0.2, 0.3, 8)))
    p = np.sqrt(np.maximum(1.0 - x**2, 0.0))[:, None] * np.ones(grid.shape)
    space = HalfSpace(grid, 1.0)
    block, exact = np.empty((len(x), len(x))), np.zeros(grid.shape)
    for j, y in enumerate(grid.y):
        for l in range(grid.shape[1]):
            fill_near(x, grid.faces[l] - y, grid.faces[l + 1] - y, block)
            exact[:, j] += block @ p[:, l]
    # Pressures that are smooth on the mesh leave less than the bound for one line.
    np.testing.assert_allclose(space.deflection(p), exact, rtol=1e-5)


def test_a_load_far_away_is_a_point():
    """w = W/r, with the next term of the order (size/r)^2."""
    grid = Grid(even_nodes(-20.0, 20.0, 0.5), np.linspace(-0.5, 0.5, 5))
    p = np.zeros(grid.shape)
    p[1] = 1.0
    assert HalfSpace(grid, 1.0).deflection(p)[-1, 1] == pytest.approx(0.5 / 39.5, rel=(0.5 / 39.5) ** 2)


def test_faces_lie_on_ends_kinks_and_middle():
    for mark in (-3.0, -2.0, 0.0, 2.0, 3.0):
        assert np.abs(GRID.faces - mark).min() < 1e-12
    np.testing.assert_array_equal(GRID.faces, -GRID.faces[::-1])
