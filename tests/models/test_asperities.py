"""Dry contact: Hertz's line contact, Greenwood and Tripp's asperities; printed numbers and quadrature."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from models.catalogue import CATALOGUE
from models.contact.asperities import (
    THICK,
    Asperities,
    area_integral,
    asperity_pressure,
    dry_separation,
    find_separation,
    load_integral,
    mean_gap,
    pressure_scale,
    pressure_under,
    real_area_share,
)
from models.contact.hertz import (
    deflection,
    elastic_compliance,
    elastic_energy,
    find_load,
    half_width,
    maximum_pressure,
)

from .systems import outputs_of

pytestmark = pytest.mark.plain

STEEL = 2.0 * 0.91 / 207e9
SURFACES = Asperities(0.2e-6, 0.05, 1e-3)


def cylinder(order: float, separation: float) -> float:
    """F_n by the parabolic cylinder function, in thirty digits."""
    with mpmath.workdps(30):
        n, s = mpmath.mpf(order), mpmath.mpf(separation)
        scale = mpmath.gamma(n + 1) / mpmath.sqrt(2 * mpmath.pi)
        return float(scale * mpmath.exp(-(s**2) / 4) * mpmath.pcfd(-n - 1, s))


# 1e-8 is what the number of Chebyshev terms was chosen for; the area's closed form cancels 2/lambda^4 of
# its digits, 1e-6 of them where it underflows.
@pytest.mark.parametrize("separation", [*np.linspace(-12.0, 12.0, 49), 20.0, 30.0, 37.0, -30.0, -100.0])
def test_integrals_are_parabolic_cylinder_functions(separation, record):
    for name, found, order, relative in (
        ("F_5/2", load_integral(separation), 2.5, 1e-8),
        ("F_2", area_integral(separation), 2.0, 1e-6),
    ):
        exact, source = cylinder(order, separation), "parabolic cylinder functions in 30 digits"
        record("Film", f"Greenwood and Tripp's {name}, -100 to 37", found, exact, source, relative=relative)


def test_the_load_integral_underflows_to_zero_and_not_to_nothing():
    assert load_integral(37.0) > 0.0
    assert load_integral(60.0) == 0.0
    assert load_integral(1e300) == 0.0


def test_pressure_and_area_are_those_of_all_pairs_of_summits(record):
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
    area = pairs(math.pi * radius / 2.0, 1.0)
    for name, found, exact in (
        ("pressure of asperities", asperity_pressure(separation, surfaces, STEEL), pressure),
        ("share of real contact", real_area_share(separation, surfaces.roughness_parameter), area),
    ):
        record("Film", name, found, exact, "Hertz's law summed over all pairs of summits", relative=1e-6)


@given(st.floats(-25.0, 30.0))
def test_the_separation_of_a_mean_gap_leads_back_to_it(separation):
    # Newton's method ends at 1e-12 of 1 + |lambda|, and the gap's closed form cancels lambda^2 of its digits.
    assert find_separation(mean_gap(separation)) == pytest.approx(separation, rel=1e-10, abs=1e-10)


@given(st.floats(1.0, 5e10))
def test_the_dry_separation_carries_the_pressure(pressure):
    separation = dry_separation(pressure, SURFACES, STEEL)
    # lambda to 1e-12, and d ln p/d lambda is at most about 9 below lambda = 8.
    assert asperity_pressure(separation, SURFACES, STEEL) == pytest.approx(pressure, rel=1e-9)


ROUGHNESS = SURFACES.roughness
SCALE = pressure_scale(SURFACES, STEEL)


# 2e-8 and 1e-7 are what the intervals were chosen for; quad's own estimates of its errors are below that.
@pytest.mark.parametrize("separation", [-6.0, -1.0, 0.4, 3.0, 7.6])
def test_pressure_and_slope_under_a_film_are_those_of_the_integrals(separation):
    """Film, pressure and slope by quadrature of their definitions: dp_a/dh = -5/2 F_3/2/Phi(lambda)."""

    def mean(of, start: float) -> float:
        value, error = quad(
            lambda s: of(s) * math.exp(-0.5 * s * s) / math.sqrt(2.0 * math.pi),
            start, start + 14.0, epsabs=0.0, epsrel=1e-11, limit=200,
        )  # fmt: skip
        assert error < 5e-9 * value
        return value

    film = ROUGHNESS * mean(lambda s: separation + s, -separation)
    pressure = SCALE * mean(lambda s: (s - separation) ** 2.5, separation)
    slope = -2.5 * SCALE * mean(lambda s: (s - separation) ** 1.5, separation)
    slope /= ROUGHNESS * mean(lambda s: 1.0, -separation)
    found = pressure_under(film, ROUGHNESS, SCALE)
    assert found.pressure == pytest.approx(pressure, rel=2e-8)
    assert found.slope == pytest.approx(slope, rel=1e-7)


gaps = st.floats(-25.0, math.log(0.999 * THICK)).map(math.exp)


@given(gaps, st.floats(1e-6, 1.0))
def test_a_thinner_film_is_pressed_more_and_more_steeply(gap, thinner):
    """F_5/2 is convex and decreasing, and the separation a concave function of the mean gap."""
    here = pressure_under(gap * ROUGHNESS, ROUGHNESS, SCALE)
    there = pressure_under(gap / (1.0 + thinner) * ROUGHNESS, ROUGHNESS, SCALE)
    assert there.pressure > here.pressure
    assert there.slope < here.slope < 0.0


def test_under_thick_films_nothing_presses_and_the_end_is_smooth_to_rounding():
    assert pressure_under(THICK * ROUGHNESS, ROUGHNESS, SCALE) == (0.0, 0.0)
    assert pressure_under(math.inf, ROUGHNESS, SCALE) == (0.0, 0.0)
    last = pressure_under(THICK * ROUGHNESS * (1.0 - 1e-12), ROUGHNESS, SCALE)
    # Beside the 1e4 Pa that films are resolved to.
    assert 0.0 < last.pressure < 1e-6
    assert abs(last.slope) * ROUGHNESS < 1e-6


def test_without_a_film_the_pressure_is_finite_and_of_no_number_none():
    vanishing, none, overlap = (pressure_under(h, ROUGHNESS, SCALE) for h in (1e-300, 0.0, -1e-6))
    assert vanishing == none == overlap
    assert 0.0 < none.pressure < math.inf
    assert math.isnan(pressure_under(math.nan, ROUGHNESS, SCALE).pressure)


LENGTH = 12e-3
COMPLIANCE = elastic_compliance(207e9, 0.3, 207e9, 0.3)

loads = st.floats(1e-3, 2e4)
radii = st.floats(5e-3, 0.1)


def test_610_newton_on_28_88_millimetres(record):
    # Half a unit of the last digit stated.
    source = "independent evaluation of Hertz's law"
    for name, law, stated, tolerance in (
        ("deflection", deflection, 1.631e-6, 0.5e-9),
        ("half width", half_width, 128.2e-6, 0.05e-6),
        ("largest pressure", maximum_pressure, 252.4e6, 0.05e6),
    ):
        value = law(610.0, 28.88e-3, LENGTH, COMPLIANCE)
        quantity = f"{name}, 610 N on a radius of 28.88 mm, length 12 mm"
        record("Contact", quantity, value, stated, source, tolerance=tolerance)


def test_contact_stiffness_at_450_newton(record):
    step = 1.0
    change = deflection(450.0 + step, 20e-3, LENGTH, COMPLIANCE)
    change -= deflection(450.0 - step, 20e-3, LENGTH, COMPLIANCE)
    quantity, source = "stiffness, 450 N on a radius of 20 mm (N/m)", "independent evaluation of Hertz's law"
    record("Contact", quantity, 2 * step / change, 3.85e8, source, relative=2e-3)


@pytest.mark.parametrize(("radius", "length"), [(0.02, 12e-3), (1.0, 1e-3)])
def test_load_is_the_inverse_of_the_deflection_and_goes_on_beyond(radius, length):
    """Up to b = L; it rises, finite, at any deflection, and goes on along the tangent."""
    assert find_load(-1e-6, radius, length, COMPLIANCE) == find_load(0.0, radius, length, COMPLIANCE) == 0.0
    deflections = np.geomspace(1e-12, 1e3, 61)
    loads = np.array([find_load(delta, radius, length, COMPLIANCE) for delta in deflections])
    assert np.all(np.isfinite(loads))
    assert np.all(np.diff(loads) > 0.0)
    for delta, load in zip(deflections, loads, strict=True):
        if half_width(load, radius, length, COMPLIANCE) < length:
            assert deflection(load, radius, length, COMPLIANCE) == pytest.approx(delta, rel=1e-12)
    edge = length**2 * (math.log(2.0) + 0.5) / (2.0 * radius)
    below, at, above = (find_load(edge * (1.0 + e), radius, length, COMPLIANCE) for e in (-1e-5, 0.0, 1e-5))
    assert half_width(at, radius, length, COMPLIANCE) == pytest.approx(length, rel=1e-9)
    # The curvature of W (c - ln(W)/2) makes 1e-5 of the slope.
    assert above - at == pytest.approx(at - below, rel=1e-4)


@given(load=loads, radius=radii)
def test_pressure_carries_the_load_and_obeys_the_width_law(load, radius):
    b = half_width(load, radius, LENGTH, COMPLIANCE)
    p = maximum_pressure(load, radius, LENGTH, COMPLIANCE)
    assert math.pi / 2 * b * p * LENGTH == pytest.approx(load, rel=1e-14)
    # K (5), which reads b/p = 2 R compliance.
    assert b / p == pytest.approx(2.0 * radius * COMPLIANCE, rel=1e-14)


@given(load=loads, radius=radii)
def test_energy_is_the_work_of_the_load(load, radius):
    deltas = np.linspace(0.0, deflection(load, radius, LENGTH, COMPLIANCE), 2001)
    work = np.trapezoid([find_load(d, radius, LENGTH, COMPLIANCE) for d in deltas], deltas)
    # Trapezoids: 2000^-2 of the curvature.
    assert elastic_energy(load, radius, LENGTH, COMPLIANCE) == pytest.approx(work, rel=1e-6)


def test_load_never_pulls_however_fast_the_surfaces_part():
    contact = CATALOGUE["ehl_contact"]()
    parting = {"approach": 1e-6, "approach_rate": -10.0, "radius_of_curvature": 0.02}
    y = outputs_of(contact, {"film_model": 7.0}, inputs=parting)
    assert y["load"] == 0.0
    assert y["separated"] == 1.0
    assert y["deflection"] == 1e-6
