"""Greenwood and Tripp's integrals and pressure, by quadrature of other kinds, and the mean gap."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from models.contact.asperities import (
    Asperities,
    area_integral,
    asperity_pressure,
    dry_separation,
    load_integral,
    mean_gap,
    real_area_share,
    separation_of,
)

STEEL = 2.0 * 0.91 / 207e9
SURFACES = Asperities(0.2e-6, 0.05, 1e-3)


def cylinder(order: float, separation: float) -> float:
    """F_n by the parabolic cylinder function, in thirty digits."""
    with mpmath.workdps(30):
        n, s = mpmath.mpf(order), mpmath.mpf(separation)
        scale = mpmath.gamma(n + 1) / mpmath.sqrt(2 * mpmath.pi)
        return float(scale * mpmath.exp(-(s**2) / 4) * mpmath.pcfd(-n - 1, s))


# To the digits that are given: half a unit of the last one.
@pytest.mark.parametrize(
    ("separation", "value", "half_unit"),
    [(0.0, 0.616634, 5e-7), (1.0, 0.0805623, 5e-8), (2.0, 5.4237e-3, 5e-8), (3.0, 1.7087e-4, 5e-9)],
)
def test_load_integral_has_the_tabulated_values(separation, value, half_unit):
    assert load_integral(separation) == pytest.approx(value, abs=half_unit)


# 1e-8 is what the number of Chebyshev terms was chosen for; the area's closed form cancels 2/lambda^4 of
# its digits, 1e-6 of them where it underflows.
@pytest.mark.parametrize("separation", [*np.linspace(-12.0, 12.0, 49), 20.0, 30.0, 37.0, -30.0, -100.0])
def test_integrals_are_parabolic_cylinder_functions(separation):
    assert load_integral(separation) == pytest.approx(cylinder(2.5, separation), rel=1e-8)
    assert area_integral(separation) == pytest.approx(cylinder(2.0, separation), rel=1e-6)


@pytest.mark.parametrize("separation", [-3.0, -0.5, 0.0, 0.7, 2.5, 5.0, 8.0])
def test_integrals_are_their_definition(separation):
    def integrand(s: float, order: float) -> float:
        return (s - separation) ** order * math.exp(-0.5 * s * s) / math.sqrt(2.0 * math.pi)

    for order, found in ((2.5, load_integral(separation)), (2.0, area_integral(separation))):
        value, error = quad(integrand, separation, separation + 12.0, (order,), epsabs=0.0, epsrel=1e-10)
        assert found == pytest.approx(value, rel=1e-7, abs=2.0 * error)


def test_the_load_integral_underflows_to_zero_and_not_to_nothing():
    assert load_integral(37.0) > 0.0
    assert load_integral(60.0) == 0.0
    assert load_integral(1e300) == 0.0


def test_the_usual_fits_of_the_load_integral_are_wrong():
    """4.4086e-5 (4 - lambda)^6.804 by -11, -3.5 and -74 % at 0, 1 and 3; the quintic is negative at 2.5."""
    quintic = np.polynomial.Polynomial([0.6167, -1.0776, 0.7844, -0.2958, 0.0574, -0.0046])
    assert quintic(2.0) / load_integral(2.0) - 1.0 == pytest.approx(-0.281, abs=0.001)
    assert quintic(2.5) < 0.0
    wrong = [4.4086e-5 * (4.0 - s) ** 6.804 / load_integral(s) - 1.0 for s in (0.0, 1.0, 3.0)]
    assert wrong == pytest.approx([-0.107, -0.035, -0.742], abs=0.002)


@given(st.floats(-20.0, 30.0), st.floats(1e-3, 3.0))
def test_more_separation_means_less_pressure_and_less_area(separation, more):
    assert load_integral(separation + more) < load_integral(separation)
    assert area_integral(separation + more) < area_integral(separation)
    assert mean_gap(separation + more) > mean_gap(separation)


def test_pressure_and_area_are_those_of_all_pairs_of_summits():
    """Hertz's law for one pair over all distances and heights, without Greenwood and Tripp's integrals."""
    roughness, density, radius = 0.3e-6, 2e9, 80e-6
    surfaces = Asperities(roughness, density * radius * roughness, roughness / radius)
    separation = 1.2

    def pairs(of: float, power: float) -> float:
        """Sum over pairs of `of` times overlap^power, for an area."""

        def ring(z: float) -> float:
            overlap = roughness * (z - separation)
            reach = 2.0 * math.sqrt(radius * overlap)
            inner, _ = quad(
                lambda r: 2.0 * math.pi * r * (max(0.0, overlap - r * r / (4.0 * radius))) ** power,
                0.0,
                reach,
            )
            return inner * math.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi)

        return density**2 * of * quad(ring, separation, separation + 10.0, epsrel=1e-9)[0]

    # quad's own tolerance for the inner integrals is 1.5e-8 of their units, far below 1e-6 of them.
    pressure = pairs(4.0 / 3.0 / STEEL * math.sqrt(radius / 2.0), 1.5)
    assert asperity_pressure(separation, surfaces, STEEL) == pytest.approx(pressure, rel=1e-6)
    area = pairs(math.pi * radius / 2.0, 1.0)
    assert real_area_share(separation, surfaces) == pytest.approx(area, rel=1e-6)


@given(st.floats(-25.0, 30.0))
def test_the_separation_of_a_mean_gap_leads_back_to_it(separation):
    # Newton's method ends at 1e-12 of 1 + |lambda|, and the gap's closed form cancels lambda^2 of its digits.
    assert separation_of(mean_gap(separation)) == pytest.approx(separation, rel=1e-10, abs=1e-10)


def test_the_mean_gap_is_the_mean_of_what_is_left_open():
    heights = np.linspace(-9.0, 9.0, 20001)
    density = np.exp(-0.5 * heights**2) / math.sqrt(2.0 * math.pi)
    for separation in (-1.5, 0.0, 1.0, 3.0):
        # Trapezoidal rule over a kink: h^2 / 8 with h = 9e-4.
        mean = float(np.trapezoid(np.maximum(separation + heights, 0.0) * density, heights))
        assert mean_gap(separation) == pytest.approx(mean, abs=1e-7)
    assert mean_gap(3.0) == pytest.approx(3.0, abs=4e-4)
    assert mean_gap(9.0) == pytest.approx(9.0, rel=1e-15)


@given(st.floats(1.0, 5e10))
def test_the_dry_separation_carries_the_pressure(pressure):
    separation = dry_separation(pressure, SURFACES, STEEL)
    # lambda to 1e-12, and d ln p/d lambda is at most about 9 below lambda = 8.
    assert asperity_pressure(separation, SURFACES, STEEL) == pytest.approx(pressure, rel=1e-9)
