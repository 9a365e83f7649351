"""Short films of journal bearings against quadrature, and their asperities."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from models.contact.asperities import Asperities, asperity_pressure
from models.contact.asperity_arc import Arc, press_arc
from models.contact.short_bearing import Squeeze, find_force, find_impedance, find_squeeze, highest_pressure

pytestmark = pytest.mark.plain

R, L, C = 12.5e-3, 12e-3, 25e-6
ANGLES = st.floats(-math.pi, math.pi)
RATIOS = st.floats(0.0, 0.99)


def polar(size, angle):
    return Squeeze(size * math.cos(angle), size * math.sin(angle))


@settings(max_examples=60, deadline=None)
@given(RATIOS, ANGLES)
@example(0.0, 0.0)
def test_the_impedance_is_the_integral_over_half_of_the_film(ratio, angle):
    xi, zeta = polar(ratio, angle)
    weights = (np.cos, np.cos), (np.sin, np.sin), (np.sin, np.cos)
    thin = min(max(angle, -1.5), 1.5)
    for found, (a, b) in zip(find_impedance(xi, zeta), weights, strict=True):
        parts = [
            quad(
                lambda t, a=a, b=b: a(t) * b(t) / (1.0 - xi * math.cos(t) - zeta * math.sin(t)) ** 3,
                *ends,
                epsabs=1e-12,
                epsrel=1e-11,
                limit=400,
            )[0]
            for ends in ((-0.5 * math.pi, thin), (thin, 0.5 * math.pi))
        ]
        assert found == pytest.approx(sum(parts), rel=1e-9, abs=1e-9)


@settings(max_examples=200, deadline=None)
@given(st.floats(0.0, 0.9999), ANGLES, ANGLES)
@example(0.0, 0.0, 0.0)
@example(0.9, math.pi, 0.0)
def test_the_mobility_is_the_inverse_of_the_impedance(ratio, angle, direction):
    """To rounding, which a thin film multiplies by (1 - eps)^-2."""
    eps, force = polar(ratio, angle), polar(1.0, direction)
    found = find_force(find_squeeze(force, eps), eps)
    assert math.hypot(found.x - force.x, found.y - force.y) < 1e-14 / (1.0 - ratio) ** 2


def test_without_force_there_is_no_motion():
    assert find_squeeze(Squeeze(0.0, 0.0), Squeeze(0.5, 0.1)) == (0.0, 0.0)
    assert find_force(Squeeze(0.0, 0.0), Squeeze(0.5, 0.1)) == (0.0, 0.0)


@pytest.mark.parametrize(("ratio", "tolerance"), [(0.1, 0.006), (0.5, 0.03), (0.9, 0.09)])
def test_the_mobility_is_near_bookers_fit(ratio, tolerance, record):
    """His curves for the short bearing, in the axes of the force: (1 - xi)^5/2/pi and
    -4 zeta (1 - xi)^3/2/pi^2, of (L/D)^2 c/(mu L D) (c/R)^2 times the force."""
    worst = 0.0
    for direction in np.linspace(-math.pi, math.pi, 73):
        eps = polar(ratio, direction)
        u = find_squeeze(Squeeze(1.0, 0.0), eps)
        fit = 2.0 * (1.0 - eps.x) ** 2.5 / math.pi, -8.0 * eps.y * (1.0 - eps.x) ** 1.5 / math.pi**2
        worst = max(worst, math.hypot(u.x - fit[0], u.y - fit[1]) / math.hypot(*fit))
    quantity = f"journal bearing at eps = {ratio:g}: mobility, largest difference from the fit (rel.)"
    record("Film", quantity, worst, 0.0, "curve fit of Booker 1971", tolerance=tolerance)


@settings(max_examples=60, deadline=None)
@given(st.floats(0.0, 0.98), ANGLES, ANGLES)
def test_the_highest_pressure_is_that_of_all_directions(ratio, angle, direction):
    eps, u = polar(ratio, angle), polar(1.0, direction)
    t = np.linspace(-math.pi, math.pi, 20001)
    around = (u.x * np.cos(t) + u.y * np.sin(t)) / (1.0 - eps.x * np.cos(t) - eps.y * np.sin(t)) ** 3
    highest = float(around.max())
    assert highest * (1.0 - 1e-12) <= highest_pressure(u, eps) <= highest * (1.0 + 1e-4)


# The asperities


@pytest.mark.parametrize("separation", [3.0, 0.0, -2.0])
def test_asperities_along_the_arc(separation):
    """Against the quadrature over the circumference, with h = c - e cos and e = c - lambda sigma. The closed
    form has h parabolic and e = c, which is lambda sigma/(2 c) = 2.4 % off at lambda = 3."""
    arc, surfaces = Arc(R, L, C), Asperities(0.4e-6, 0.05, 1e-3)

    def pressure(t):
        more = (C - separation * 0.4e-6) * (1.0 - math.cos(t)) / 0.4e-6
        return asperity_pressure(separation + more, surfaces, 1e-11) * math.cos(t)

    expected = 2.0 * R * L * quad(pressure, 0.0, 0.8, epsrel=1e-10)[0]
    assert press_arc(separation, arc, surfaces, 1e-11).load == pytest.approx(expected, rel=0.03)


@settings(max_examples=40, deadline=None)
@given(st.floats(-6.0, 7.9))
def test_the_energy_of_the_asperities_is_the_work_of_their_load(separation):
    arc, surfaces, h = Arc(R, L, C), Asperities(0.4e-6, 0.05, 1e-3), 1e-4

    def at(place):
        return press_arc(place, arc, surfaces, 1e-11)

    work = (at(separation - h).energy - at(separation + h).energy) / (2.0 * h * 0.4e-6)
    assert at(separation).load == pytest.approx(work, rel=1e-5, abs=1e-6)
