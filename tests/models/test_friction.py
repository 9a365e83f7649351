"""Sharing of the load between film and asperities, and the friction of both."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
from models.contact.asperities import Asperities, asperity_pressure, find_separation, real_area_share
from models.contact.films import FILMS
from models.contact.films.groups import Conditions
from models.contact.fluid import Lubricant, viscosity_at
from models.contact.friction import (
    Traction,
    hertzian_friction,
    profile_friction,
    shear_stress,
    viscous_friction,
)
from models.contact.hertz import elastic_compliance, half_width, maximum_pressure
from models.contact.load_sharing import formula_film, share_load

from .systems import outputs_of

pytestmark = pytest.mark.plain

LENGTH, RADIUS = 12e-3, 0.03
STEEL = elastic_compliance(207e9, 0.3, 207e9, 0.3)
SURFACES = Asperities(0.2e-6, 0.05, 1e-3)
OIL = Lubricant(0.036, 1.8e-8)
EYRING = OIL._replace(eyring_stress=5e6)
fluids = st.sampled_from([OIL, EYRING])
UNLIMITED = {"limiting_stress": 1e30, "limiting_coefficient": 0.0}
CONTACT = CATALOGUE["ehl_contact"]()

loads = st.floats(1e-2, 2e4)
speeds = st.floats(1e-9, 20.0)
films = st.floats(1e-12, 5e-6)
# Nothing, or what a rounding of something else is far below.
velocities = st.one_of(st.just(0.0), st.floats(1e-9, 20.0), st.floats(-20.0, -1e-9))
some_or_no_load = st.one_of(st.just(0.0), st.floats(1e-6, 1e4))
wet = st.sampled_from([name for name in FILMS if name != "dry"])


def formula(name: str, velocity: float) -> tuple[float, Conditions]:
    """The formula's number, and what it is asked at."""
    at = Conditions(velocity, RADIUS, LENGTH, STEEL, OIL.viscosity, OIL.pressure_viscosity)
    return float(list(FILMS).index(name)), at


def area(load: float) -> float:
    return 2.0 * half_width(load, RADIUS, LENGTH, STEEL) * LENGTH


def steady(load: float, name: str, velocity: float):
    number, at = formula(name, velocity)
    return share_load(load, formula_film(number, load, at), area(load), SURFACES, number, at)


@given(loads, speeds, wet)
def test_film_and_asperities_carry_the_load(load, velocity, name):
    """W_f + W_a = W with W_f = the load at which the formula gives the film, W_a that of its separation."""
    found = steady(load, name, velocity)
    own = area(load) * asperity_pressure(find_separation(found.film / SURFACES.roughness), SURFACES, STEEL)
    # The law of the separation is good to 1e-8, that of the film to 2e-8.
    assert found.asperity_load == pytest.approx(own, rel=3e-8)
    assert 0.0 <= found.asperity_load <= load
    # Formulas that grow with the load keep their film; the others' is that of the fluid's share, as long as
    # it is a share that a formula is asked at (1e-12), which a film far thinner than the roughness is not.
    fluid = load - found.asperity_load
    if name != "kushwaha" and fluid > 1e-6 * load:
        # The fluid's share cancels up to six digits of a double.
        number, at = formula(name, velocity)
        assert found.film == pytest.approx(formula_film(number, fluid, at), rel=1e-9)


@given(loads, st.floats(1e-7, 1e-5), wet)
def test_at_rest_asperities_carry_all_and_under_thick_films_nothing(load, thick, name):
    f = formula(name, 0.0)
    rest = share_load(load, 0.0, area(load), SURFACES, *f)
    assert rest.asperity_load == load
    assert rest.film == 0.0
    # Formulas without a limit for a load of zero leave at most a share of 1e-4 at 1e-12 m/s.
    assert share_load(load, 1e-12, area(load), SURFACES, *f).asperity_load == pytest.approx(load, rel=1e-3)
    assert share_load(load, 8.0 * SURFACES.roughness + thick, area(load), SURFACES, *f).asperity_load == 0.0


@given(loads, films, st.floats(1.001, 3.0), wet)
def test_a_thicker_film_leaves_less_to_asperities(load, film, factor, name):
    f = formula(name, 1.0)
    thin, thick = (share_load(load, h, area(load), SURFACES, *f) for h in (film, factor * film))
    # Rounding of the search: far below the roughness, a film's pressure hardly says how thick it is.
    assert thick.asperity_load <= thin.asperity_load * (1.0 + 1e-10)
    assert thick.film >= thin.film * (1.0 - 1e-8)


@given(st.floats(0.0, 3e9), velocities, st.floats(1e-9, 1e-5), fluids)
def test_shear_stress_is_odd_bounded_and_never_above_newtons(pressure, velocity, film, fluid):
    traction = Traction()
    stress = shear_stress(pressure, velocity, film, fluid, traction)
    assert stress == -shear_stress(pressure, -velocity, film, fluid, traction)
    assert stress * velocity >= 0.0
    limit = traction.limiting_stress + traction.limiting_coefficient * pressure
    assert abs(stress) <= min(limit, viscosity_at(pressure, OIL) * abs(velocity) / film) * (1.0 + 1e-12)


def test_eyrings_law_is_newtons_at_small_stress_and_its_logarithm_at_large():
    unlimited = Traction(**UNLIMITED)
    # asinh x = x - x^3/6: x = 7.2e-5 here.
    newtonian = OIL.viscosity * 1e-2 / 1e-6
    assert shear_stress(0.0, 1e-2, 1e-6, EYRING, unlimited) == pytest.approx(newtonian, rel=1e-8)
    # asinh x = ln 2x + 1/(4 x^2).
    many = viscosity_at(8e8, OIL) * 5.0 / 1e-7
    expected = EYRING.eyring_stress * math.log(2.0 * many / EYRING.eyring_stress)
    assert shear_stress(8e8, 5.0, 1e-7, EYRING, unlimited) == pytest.approx(expected, rel=1e-8)


def test_friction_of_a_constant_viscosity_is_a_closed_form(record):
    """eta u_s/h over the area; and of the limiting stress alone, gamma W + tau_L0 A."""
    water = Lubricant(1e-3, 1e-8, viscosity_law=2.0)
    b, p0 = half_width(500.0, RADIUS, LENGTH, STEEL), maximum_pressure(500.0, RADIUS, LENGTH, STEEL)
    newtonian = Traction(**UNLIMITED)
    found = viscous_friction(b, LENGTH, p0, 2.0, 1e-7, water, newtonian)
    # Twelve Gauss points integrate a cosine to rounding.
    exact = 1e-3 * 2.0 / 1e-7 * area(500.0)
    record("Film", "friction of a constant viscosity (N)", found, exact, "η u A / h", relative=1e-13)
    limited = Traction(limiting_stress=1e6, limiting_coefficient=0.05)
    found = viscous_friction(b, LENGTH, p0, -1e9, 1e-7, water, limited)
    exact = -(0.05 * 500.0 + 1e6 * area(500.0))
    record("Film", "friction at the limiting stress (N)", found, exact, "-(γ W + τ A)", relative=1e-13)


@pytest.mark.parametrize(
    ("fluid", "load", "film", "velocity"), [(OIL, 50.0, 1e-6, 1.0), (EYRING, 5e3, 5e-7, 8.0)]
)
def test_friction_of_hertzs_pressure_is_that_of_its_profile(fluid, load, film, velocity):
    b, p0 = half_width(load, RADIUS, LENGTH, STEEL), maximum_pressure(load, RADIUS, LENGTH, STEEL)
    traction = Traction()
    x = b * np.sin(np.linspace(-math.pi / 2.0, math.pi / 2.0, 4001))
    pressure = p0 * np.sqrt(1.0 - np.clip(x / b, -1.0, 1.0) ** 2)
    stress = np.array([shear_stress(p, velocity, film, fluid, traction) for p in pressure])
    profile = profile_friction(
        x, pressure, np.full_like(x, film), stress, LENGTH, velocity, STEEL, SURFACES, traction
    )
    # Twelve points: 2e-3 where the limiting stress makes a kink.
    assert viscous_friction(b, LENGTH, p0, velocity, film, fluid, traction) == pytest.approx(
        profile.viscous, rel=2e-3
    )
    assert profile.boundary == pytest.approx(traction.boundary_coefficient * profile.asperity_load, rel=1e-14)


def test_profile_of_one_film_has_the_asperity_load_of_its_area():
    x = np.linspace(-1e-4, 1e-4, 11)
    film = np.full_like(x, 0.2e-6)
    at_rest = profile_friction(
        x,
        np.zeros_like(x),
        film,
        np.ones_like(x),
        LENGTH,
        1.0,
        STEEL,
        SURFACES,
        Traction(boundary_stress=2e6),
    )
    one = asperity_pressure(0.8994715612537435, SURFACES, STEEL)  # mean gap 1
    assert at_rest.asperity_load == pytest.approx(2e-4 * LENGTH * one, rel=1e-9)
    assert at_rest.viscous == 0.0
    assert at_rest.boundary == pytest.approx(0.1 * at_rest.asperity_load + 2e6 * at_rest.real_area, rel=1e-14)


def test_a_dry_contact_slides_by_coulombs_law():
    out = outputs_of(
        CONTACT,
        {"film_model": float(list(FILMS).index("dry")), "boundary_friction_coefficient": 0.12},
        inputs={"approach": 2e-6, "sliding_velocity": -3.0, "entraining_velocity": 1.0},
    )
    assert out["friction_force"] == pytest.approx(-0.12 * out["load"], rel=1e-14)
    assert out["asperity_load"] == out["load"] > 0.0
    assert out["viscous_friction"] == 0.0


@given(
    some_or_no_load, st.floats(1e-10, 3e-6), velocities, velocities, wet,
    st.sampled_from([0.0, 5e6]),
)  # fmt: skip
def test_friction_of_the_contact_takes_energy_and_is_odd_in_the_sliding(load, film, u, slide, name, eyring):
    parameters = {"film_model": float(list(FILMS).index(name)), "load_is_given": 1.0, "eyring_stress": eyring}
    one, other = (
        outputs_of(
            CONTACT,
            parameters,
            {"film_thickness": film},
            {"applied_load": load, "entraining_velocity": u, "sliding_velocity": sign * slide},
        )
        for sign in (1.0, -1.0)
    )
    for variable in ("friction_force", "viscous_friction", "boundary_friction"):
        assert one[variable] * slide >= 0.0
        assert one[variable] == -other[variable]
    assert one["friction_force"] == one["viscous_friction"] + one["boundary_friction"]
    # At most the limiting stress, gamma W_f + tau_L0 A (the quadrature of both is exact), and mu_b W_a.
    limit = 2e6 * 2.0 * one["half_width"] * LENGTH + 0.07 * (load - one["asperity_load"])
    assert abs(one["viscous_friction"]) <= limit * (1.0 + 1e-9)
    assert abs(one["boundary_friction"]) == pytest.approx(
        0.1 * one["asperity_load"] * (slide != 0.0), rel=1e-14
    )


def test_asperities_that_shear_do_so_on_the_real_area_that_carries_their_load():
    """mu_b W_a + tau_b A_c, A_c that of the separation at which asperities carry W_a."""
    carried, b = steady(500.0, "moes_venner", 1e-2), half_width(500.0, RADIUS, LENGTH, STEEL)
    law = Traction(boundary_coefficient=0.1, boundary_stress=2e6)
    force = hertzian_friction(500.0, b, LENGTH, 1.0, carried, OIL, SURFACES, STEEL, law)
    share = real_area_share(find_separation(carried.film / SURFACES.roughness), SURFACES.roughness_parameter)
    expected = 0.1 * carried.asperity_load + 2e6 * area(500.0) * share
    # The laws of asperities are good to 3e-8.
    assert force.boundary == pytest.approx(expected, rel=1e-7)


def test_stribecks_curve_falls_from_boundary_to_mixed_friction():
    """Less speed, less film, more friction, up to the coefficient of the asperities."""
    coefficients = []
    for velocity in (1e-7, 1e-4, 1e-3, 1e-2, 0.1):
        carried = steady(500.0, "moes_venner", velocity)
        b = half_width(500.0, RADIUS, LENGTH, STEEL)
        force = hertzian_friction(500.0, b, LENGTH, velocity, carried, OIL, SURFACES, STEEL, Traction())
        coefficients.append((force.viscous + force.boundary) / 500.0)
    assert coefficients == sorted(coefficients, reverse=True)
    assert coefficients[0] == pytest.approx(0.1, rel=0.01)
    assert coefficients[-1] < 0.05
