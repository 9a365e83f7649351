"""Viscosity over pressure and temperature, and shear stress up to its limit."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.contact.fluid import Lubricant, log_viscosity
from models.contact.oil_grades import GRADES
from models.contact.oils import ROELANDS_PRESSURE, ZERO_CELSIUS, density, evaluate_oil, kinematic_viscosity
from models.contact.rheology import (
    GRADUAL,
    LIMITING_LAWS,
    Thermal,
    fluid_stress,
    limited_stress,
    pressed_share,
    thin_by_heat,
)

pytestmark = pytest.mark.plain

grades = st.sampled_from(sorted(GRADES))
pressures = st.floats(0.0, 2e9)
rises = st.floats(0.0, 300.0)
stresses = st.floats(1.0, 1e12)
limits = st.floats(1e5, 1e9)


def oil_at(grade: str, celsius: float, law: float = 0.0) -> tuple[Lubricant, Thermal]:
    temperature = ZERO_CELSIUS + celsius
    oil = evaluate_oil(GRADES[grade], temperature)
    fluid = Lubricant(oil.viscosity, oil.pressure_viscosity, law, 0.0, oil.roelands_exponent)
    return fluid, Thermal(temperature, oil.temperature_viscosity)


def log_at(pressure: float, rise: float, fluid: Lubricant, thermal: Thermal) -> float:
    """ln(eta/eta0), as the layers of a heated film take it."""
    thinned = thin_by_heat(rise, fluid.viscosity, thermal).value
    return log_viscosity(pressure, fluid)[0] + pressed_share(pressure, fluid) * thinned


@given(grades, rises)
def test_the_slope_is_that_of_the_law(grade, rise):
    fluid, thermal = oil_at(grade, 90.0)
    up, here, down = (thin_by_heat(rise + dt, fluid.viscosity, thermal) for dt in (0.1, 0.0, -0.1))
    # Central differences: rounding of a value up to 10 over the step, and their third derivative.
    assert (up.value - down.value) / 0.2 == pytest.approx(here.slope, rel=1e-6, abs=1e-12)


@given(grades, st.floats(40.0, 120.0))
def test_it_is_roelands_law_of_both_at_the_grades_numbers(grade, celsius):
    """ln(eta) + 9.67 = (ln(eta0) + 9.67) (1 + p/p_r)^z theta^-S, where alpha and z go together."""
    fluid, thermal = oil_at(grade, 90.0)
    c, pole = math.log(fluid.viscosity) + 9.67, thermal.temperature - 138.0
    theta = (ZERO_CELSIUS + celsius - 138.0) / pole
    pressed = (1.0 + 8e8 / ROELANDS_PRESSURE) ** fluid.roelands_exponent
    log = c * pressed * theta ** (-thermal.temperature_viscosity * pole / c) - c
    found = log_at(8e8, celsius - 90.0, fluid, thermal)
    assert found == pytest.approx(log, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("celsius", [40.0, 120.0, 150.0])
def test_it_follows_walthers_equation_of_the_grade(celsius):
    """From 90 degC: within 6.5 %; only the slope at 90 degC is common to both."""
    for grade in sorted(GRADES):
        fluid, thermal = oil_at(grade, 90.0)
        hot = math.exp(log_at(0.0, celsius - 90.0, fluid, thermal)) * fluid.viscosity
        assert hot == pytest.approx(oil_viscosity(grade, celsius), rel=0.065)


def oil_viscosity(grade: str, celsius: float) -> float:
    kelvin = ZERO_CELSIUS + celsius
    return kinematic_viscosity(GRADES[grade], kelvin) * density(GRADES[grade], kelvin)


@given(stresses, limits, st.sampled_from([0.0, 5e6]), st.sampled_from(range(len(LIMITING_LAWS))))
def test_stress_grows_with_the_rate_up_to_its_limit(newtonian, limit, eyring, law):
    stress = limited_stress(fluid_stress(newtonian, eyring), limit, float(law))
    more = limited_stress(fluid_stress(1.1 * newtonian, eyring), limit, float(law))
    assert 0.0 < stress <= more <= limit
    assert stress <= newtonian * (1.0 + 1e-12)
    assert limited_stress(stress, 0.0, float(law)) == 0.0


@given(limits)
def test_the_gradual_limit_is_bairs_and_winers(limit):
    """eta rate = -tau_L ln(1 - tau/tau_L); Newton's at small stress, the limit at large."""
    for share in (0.01, 0.5, 0.99):
        newtonian = -limit * math.log1p(-share)
        assert limited_stress(newtonian, limit, GRADUAL) == pytest.approx(share * limit, rel=1e-12)
    assert limited_stress(1e-9 * limit, limit, GRADUAL) == pytest.approx(1e-9 * limit, rel=1e-8)
    assert limited_stress(50.0 * limit, limit, GRADUAL) == limit
