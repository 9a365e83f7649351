"""Heat in the inlet: limits, similarity, another fit, and the film of the contact."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
from models.contact.hertz import elastic_compliance
from models.contact.inlet_heating import thermal_reduction

from ..systems import outputs_of, rates_of

COMPLIANCE = elastic_compliance(207e9, 0.3, 207e9, 0.3)
CONTACT = CATALOGUE["ehl_contact"]()
# Magnitudes of cam contacts.
PRESSURES = st.floats(0.0, 1.5e9)
VELOCITIES = st.floats(0.01, 15.0)
SLIDING = st.floats(-15.0, 15.0)
VISCOSITIES = st.floats(2e-3, 0.3)


def reduction(pressure, velocity, sliding, viscosity, temperature_viscosity=0.03, conductivity=0.14):
    oil = (viscosity, temperature_viscosity, conductivity)
    return thermal_reduction(pressure, velocity, sliding, COMPLIANCE, *oil)


@given(PRESSURES, VELOCITIES, SLIDING, VISCOSITIES)
def test_heat_thins_the_film_more_with_pressure_speed_sliding_and_viscosity(p, u, us, eta):
    found = reduction(p, u, us, eta)
    assert 0.0 < found < 1.0
    assert reduction(1.1 * p, u, us, eta) <= found
    assert reduction(p, 1.1 * u, 1.1 * us, eta) < found
    assert reduction(p, u, 1.1 * us + math.copysign(0.1, us), eta) < found
    assert reduction(p, u, us, 1.1 * eta) < found
    assert reduction(p, -u, us, eta) == reduction(p, u, -us, eta) == found


@given(PRESSURES, SLIDING, VISCOSITIES)
def test_there_is_no_heat_at_rest_without_sliding_or_a_coefficient(p, us, eta):
    """As u tends to zero with a given sliding velocity, by u^0.42."""
    assert reduction(p, 0.0, us, eta) == 1.0
    assert reduction(p, 1e-12, us, eta) == pytest.approx(1.0, abs=1e-3)
    assert reduction(p, 3.0, us, eta, temperature_viscosity=0.0) == 1.0


@pytest.mark.parametrize("loading", [0.1, 0.3, 1.0, 3.0, 10.0])
def test_rolling_agrees_with_another_fit(loading, record):
    """Murch and Wilson (1975), 3.94/(3.94 + L^0.62), from a thermal Reynolds equation of the inlet."""
    velocity = math.sqrt(loading * 0.14 / (0.03 * 0.05))
    found = reduction(0.002 * 2.0 / COMPLIANCE, velocity, 0.0, 0.05)
    other = 3.94 / (3.94 + loading**0.62)
    quantity = "share of the film that heat in the inlet leaves, rolling, L = 0.1 to 10"
    record("Film", quantity, found, other, "Murch and Wilson (1975)", relative=0.02)


def test_the_film_of_the_contact_is_the_isothermal_one_times_the_reduction():
    """At the same load; the film relaxes to it."""
    inputs = {"applied_load": 500.0, "entraining_velocity": 5.0, "sliding_velocity": 8.0}
    given_load = {"load_is_given": 1.0}
    cold = outputs_of(CONTACT, given_load, inputs=inputs)
    heated = {**given_load, "inlet_heating": 1.0}
    hot = outputs_of(CONTACT, heated, inputs=inputs)
    expected = reduction(cold["maximum_pressure"], 5.0, 8.0, 0.036)
    assert cold["thermal_reduction"] == 1.0
    assert hot["thermal_reduction"] == pytest.approx(expected, rel=1e-14)
    assert hot["steady_film_thickness"] == pytest.approx(expected * cold["steady_film_thickness"], rel=1e-14)
    there = {"film_thickness": hot["steady_film_thickness"]}
    rate = rates_of(CONTACT, heated, inputs=inputs, state=there)["film_thickness"]
    assert rate == pytest.approx(0.0, abs=1e-12)


def test_the_reduction_is_that_of_gupta_and_others():
    """Their fit at L = 0.03 0.1 16/0.14 and S = 4, p0 = 0.5 GPa."""
    loading = 0.03 * 0.1 * 16.0 / 0.14
    pressed = 1.0 - 13.2 * 0.5e9 * 0.5 * COMPLIANCE * loading**0.42
    sheared = 1.0 + 0.213 * (1.0 + 2.23 * 4.0**0.83) * loading**0.64
    assert reduction(0.5e9, 4.0, -16.0, 0.1) == pytest.approx(pressed / sheared, rel=1e-12)
