"""Hertz's line contact: printed numbers, round trip, energy, symmetry."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
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


@given(load=loads, radius=radii)
def test_load_of_the_deflection_is_the_load(load, radius):
    delta = deflection(load, radius, LENGTH, COMPLIANCE)
    # Newton to rounding; the deflection's own rounding is magnified by less than 2.
    assert find_load(delta, radius, LENGTH, COMPLIANCE) == pytest.approx(load, rel=4e-15)


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
