"""Films between two axial grooves: their axial modes, their potential, and the inverse of their impedance.

`test_bearing_films` compares them with Reynolds' equation.
"""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.linalg import eigh

from models.contact.analysis.bearing.reynolds import Grid, solve
from models.contact.analysis.bearing.steady import GROOVE, WEDGE
from models.contact.grooved_bearing import (
    SQUARES,
    WEIGHTS,
    Grooves,
    find_grooved_impedance,
    find_grooved_squeeze,
)
from models.contact.grooved_pressure import find_grooved_pressure
from models.contact.short_bearing import Squeeze, highest_pressure

pytestmark = pytest.mark.plain

ANGLES = st.floats(-math.pi, math.pi)


def polar(size, angle):
    return Squeeze(size * math.cos(angle), size * math.sin(angle))


def test_the_axial_modes_are_galerkins():
    """Of -P'' + D P = 1 over -1 to 1 with P = 0 at both ends, for (1 - Y^2) (1, Y^2)."""
    shapes = [np.polynomial.Polynomial(c) for c in ((1.0, 0.0, -1.0), (0.0, 0.0, 1.0, 0.0, -1.0))]

    def mean(shape):
        return 0.5 * float(np.diff(shape.integ()([-1.0, 1.0]))[0])

    bending, mass = (
        np.array([[mean(f(a) * f(b)) for a in shapes] for b in shapes])
        for f in (lambda a: a.deriv(), lambda a: a)
    )
    squares, vectors = eigh(bending, mass)
    assert pytest.approx(squares, rel=1e-12) == SQUARES
    assert pytest.approx((vectors.T @ [mean(a) for a in shapes]) ** 2, rel=1e-12) == WEIGHTS


def grooved(direction, eps, ratio=0.5):
    """The impedance for a squeeze in this direction, with eps along x and grooves of 20 degrees."""
    k = find_grooved_impedance(polar(1.0, direction), polar(eps, 0.0), Grooves(ratio, 0.4, GROOVE))
    return np.array(k)


@pytest.mark.parametrize("ratio", [0.25, 1.0])
@pytest.mark.parametrize("eps", [0.3, 0.8, 0.95])
def test_squeezes_in_all_directions(eps, ratio, record):
    """The largest difference of the force, over its size, in nine directions."""
    worst, grid = 0.0, Grid(eps, ratio, (0.4, 0.4 + math.pi), opening=GROOVE)
    for direction in np.arange(0.1, 2.0 * math.pi, 0.7):
        exact = solve(grid, direction).force
        along, _, mixed = grooved(direction, eps, ratio)
        u = polar(1.0, direction)
        off = math.hypot(along * u.x - mixed * u.y - exact[0], along * u.y + mixed * u.x - exact[1])
        worst = max(worst, off / math.hypot(*exact))
    quantity = f"journal bearing with two grooves, L/D = {ratio:g}, eps = {eps:g}: force of a squeeze (rel.)"
    record("Film", quantity, worst, 0.0, "Reynolds' equation, p >= 0", tolerance=0.01)


@pytest.mark.parametrize("degrees", [20.0, 80.0])
@pytest.mark.parametrize("ratio", [0.25, 0.5, 1.0])
@pytest.mark.parametrize("eps", [0.1, 0.8, 0.95])
def test_the_highest_pressure_of_a_turning_journal(eps, ratio, degrees, record):
    """The largest difference for grooves at six angles from the thin place."""
    worst, width = 0.0, math.radians(degrees)
    for angle in np.arange(-1.5, 1.5, 0.5):
        exact = solve(Grid(eps, ratio, (angle, angle + math.pi), opening=width), WEDGE).highest
        found = find_grooved_pressure(polar(1.0, WEDGE), polar(eps, 0.0), Grooves(ratio, angle, width))
        worst = max(worst, abs(6.0 * ratio**2 * found / exact - 1.0))
    quantity = f"journal bearing, two grooves of {degrees:g} degrees, L/D = {ratio:g}, eps = {eps:g}"
    source = "Reynolds' equation, p >= 0"
    record("Film", f"{quantity}: highest pressure (rel.)", worst, 0.0, source, tolerance=0.01)


@settings(max_examples=40, deadline=None)
@given(st.floats(0.0, 0.9), ANGLES, ANGLES, st.floats(0.1, 10.0))
def test_the_pressure_between_grooves_is_less_than_in_a_short_film(eps, angle, direction, size):
    """Flow round the journal relieves it. It is proportional to the squeeze."""
    u, at, grooves = polar(1.0, direction), polar(eps, angle), Grooves(0.5, 0.4, GROOVE)
    found = find_grooved_pressure(u, at, grooves)
    assert 0.0 < found < 1.001 * highest_pressure(u, at)
    assert find_grooved_pressure(polar(size, direction), at, grooves) == pytest.approx(size * found)


@settings(max_examples=40, deadline=None)
@given(st.floats(0.0, 0.95), ANGLES, st.floats(0.2, 1.0))
def test_a_film_between_grooves_takes_power_and_has_a_potential(eps, direction, ratio):
    """The force is the gradient of half of what A has along u, a convex function."""
    along, across, mixed = grooved(direction, eps, ratio)
    assert along > 0.0
    assert along * across > mixed**2
    slope = (grooved(direction + 1e-4, eps, ratio)[0] - grooved(direction - 1e-4, eps, ratio)[0]) / 4e-4
    assert mixed == pytest.approx(slope, abs=1e-3 * (along + across))


@pytest.mark.parametrize("eps", [0.3, 0.8, 0.95])
def test_nothing_jumps_where_a_squeeze_passes_a_groove(eps):
    """Second differences of the force over the direction fall with the square of the step."""
    for at in (
        0.4 + side * 0.5 * GROOVE + turn for side in (-1.0, 1.0) for turn in (0.5 * math.pi, -0.5 * math.pi)
    ):
        forces = np.array([grooved(at + step, eps)[[0, 2]] for step in 5e-4 * np.arange(-4, 5)])
        assert np.abs(np.diff(forces, 2, axis=0)).max() < 2e-5 * np.abs(forces).max()


@settings(max_examples=40, deadline=None)
@given(st.floats(0.0, 0.99), ANGLES, ANGLES)
@example(0.0, 0.0, 0.0)
def test_the_squeeze_between_grooves_is_the_inverse_of_the_impedance(eps, angle, direction):
    force, at = polar(3.0, direction), polar(eps, angle)
    grooves = Grooves(0.5, 0.4, GROOVE)
    u = find_grooved_squeeze(force, at, grooves)
    size = math.hypot(*u)
    k = find_grooved_impedance(Squeeze(u.x / size, u.y / size), at, grooves)
    found = u.x * k.along - u.y * k.mixed, u.y * k.along + u.x * k.mixed
    assert found == pytest.approx(force, abs=1e-7)
