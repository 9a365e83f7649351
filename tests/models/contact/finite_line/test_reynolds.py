"""The balance of the cells: its tangents, its means, and what flows."""

from __future__ import annotations

import math

import numpy as np
import pytest

from models.contact.analysis.finite_line.grid import Grid
from models.contact.analysis.finite_line.inlet import rise
from models.contact.analysis.finite_line.linear import along_stencil
from models.contact.analysis.finite_line.reynolds import Balance, logarithmic_mean
from models.contact.fluid import Lubricant

FACES = np.array([-1.3, -0.7, 0.3, 0.7, 2.3])
WIDTHS = np.diff(FACES)


def graded(nodes):
    """Steps of 0.1 to 0.2."""
    return Grid(np.cumsum(np.random.default_rng(1).uniform(0.1, 0.2, nodes)), FACES)


@pytest.mark.parametrize("difference", [9e-4, 1.1e-3, 5.0])
def test_the_logarithmic_mean_and_its_slopes(difference):
    """Against the integral that it is: of e^t between both, by its mean value; slopes by differences."""
    a, b = -0.7, -0.7 + difference
    t = np.linspace(0.0, 1.0, 20001)
    mean, by_a, by_b = logarithmic_mean(a, b)
    # Trapezoids on 20000 intervals; cancellation in e^b - e^a just above the change to the series.
    assert mean == pytest.approx(np.trapezoid(np.exp(a + (b - a) * t), t), rel=1e-8)
    step = 1e-5
    slope_a = (logarithmic_mean(a + step, b)[0] - logarithmic_mean(a - step, b)[0]) / (2 * step)
    slope_b = (logarithmic_mean(a, b + step)[0] - logarithmic_mean(a, b - step)[0]) / (2 * step)
    assert (by_a, by_b) == (pytest.approx(slope_a, rel=1e-6), pytest.approx(slope_b, rel=1e-6))


@pytest.mark.parametrize(("viscosity_law", "density_law"), [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)])
def test_tangents_are_those_of_the_balance(viscosity_law, density_law):
    """Central differences in a random direction of p and h: an error of step^2."""
    random = np.random.default_rng(2)
    fluid = Lubricant(0.036, 1.8e-8, viscosity_law, density_law)
    balance = Balance(graded(9), 3e8, fluid)
    p, h = random.random((9, 4)), 0.3 + random.random((9, 4))
    dp, dh = random.random((9, 4)), random.random((9, 4))
    _, by_p, by_h = balance(p, h, 0.4)
    step = 1e-5
    up = balance(p + step * dp, h + step * dh, 0.4)[0]
    down = balance(p - step * dp, h - step * dh, 0.4)[0]
    inside = slice(2, -1)
    tangent = along_stencil(by_p, dp) + along_stencil(by_h, dh)
    np.testing.assert_allclose(tangent[inside], ((up - down) / (2 * step))[inside], rtol=1e-6, atol=1e-6)


def test_what_leaves_one_cell_enters_the_next():
    """The sum over a block of cells is what passes its rim: cells inside have no part in it."""
    random = np.random.default_rng(3)
    grid = graded(12)
    balance = Balance(grid, 3e8, Lubricant(0.036, 1.8e-8))
    p, h = random.random((12, 4)), 0.3 + random.random((12, 4))
    other = p.copy()
    other[5, 1:3] *= 2.0
    block = slice(3, 9)
    sums = [float(np.sum(balance(each, h, 0.4)[0][block] * grid.areas[block])) for each in (p, other)]
    ends = [
        float(np.sum(balance(each, h, 0.4)[0][block, 1:3] * grid.areas[block, 1:3])) for each in (p, other)
    ]
    assert sums[0] == pytest.approx(sums[1], rel=1e-12, abs=1e-10)
    assert abs(ends[0] - ends[1]) > 1e-3  # along y it does pass the rim


def test_the_inlet_of_a_parabola():
    """h = c x^2/2: the integral of 1/h^2 - h*/h^3 has a closed form."""
    first, curvature, flow = 3.0, 2.0, 0.4
    film = 0.5 * curvature * first**2
    exact = 4.0 / (3.0 * curvature**2 * first**3) - flow * 8.0 / (5.0 * curvature**3 * first**5)
    # Simpson's rule integrates these powers of 1/x exactly up to x^-4 (measure included).
    assert rise(first, film, curvature, flow) == pytest.approx(exact, rel=1e-6)
    assert math.isfinite(rise(1e-3, 1.0, 0.1, 0.5))


def test_the_flow_through_a_taper_is_of_second_order():
    """h linear along x, constant viscosity: dp/dx = wedge (h - h*)/h^3, whose p leaves the cells balanced."""
    wedge, slope, flow = 0.4, -0.3, 0.55
    missed = []
    for nodes in (17, 33, 65):
        grid = Grid(np.linspace(0.1, 1.5, nodes), np.array([-1e4, 0.0, 1e4]))
        film = 1.0 + slope * grid.x
        p = wedge / slope * (flow / (2.0 * film**2) - 1.0 / film)
        balance = Balance(grid, 1.0, Lubricant(0.036, 0.0, 2.0, 1.0))
        g, _, _ = balance(np.outer(p, [1.0, 1.0]), np.outer(film, [1.0, 1.0]), wedge)
        missed.append(float(np.max(np.abs(g[2:-1]))))
    # The largest error lies at the last cell, whose place moves with the grid.
    orders = np.log2(np.array(missed[:-1]) / missed[1:])
    assert orders == pytest.approx([2.0, 2.0], abs=0.1)
