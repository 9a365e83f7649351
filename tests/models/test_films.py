"""Film formulas: similarity, asymptotes, and the relaxation equation of the film."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.special import lambertw

from models.catalogue import CATALOGUE
from models.contact.ehl_contact import relaxation_rate
from models.contact.films import FILMS, film_by_number
from models.contact.films.groups import Conditions
from models.contact.films.moes_venner import moes_film
from models.contact.hertz import elastic_compliance

from .systems import outputs_of, rates_of

pytestmark = pytest.mark.plain

C = 96.775
AT = {
    "velocity": 2.0,
    "radius": 0.03,
    "length": 12e-3,
    "compliance": elastic_compliance(207e9, 0.3, 207e9, 0.3),
    "viscosity": 0.036,
    "pressure_viscosity": 1.8e-8,
}


def film(name, load=500.0, **changed):
    return FILMS[name](load, Conditions(**{**AT, **changed}))


@pytest.mark.parametrize("name", FILMS)
@given(velocity=st.floats(0.0, 50.0), log_load=st.floats(-12.0, 6.0), log_radius=st.floats(-4.0, 1.0))
def test_films_are_finite_and_not_negative_from_rest_on(name, velocity, log_load, log_radius):
    thickness = film(name, velocity=velocity, load=10.0**log_load, radius=10.0**log_radius)
    assert 0.0 <= thickness < math.inf


def test_the_numbers_of_shipped_formulas_stay():
    """FMUs and saved scenarios have them."""
    assert list(FILMS)[:8] == [
        "kushwaha", "kushwaha_negative", "dowson_higginson", "dowson_toyoda", "pan_hamrock_minimum",
        "pan_hamrock_central", "moes_venner", "dry",
    ]  # fmt: skip


def test_numbers_choose_the_formulas():
    for number, name in enumerate(FILMS):
        assert film_by_number(float(number), 500.0, Conditions(**AT)) == film(name)


def test_moes_asymptotes(record):
    for name, M, L, asymptote in (
        ("rigid-isoviscous", 1e-4, 0.0, 2.45e4),
        ("elastic-isoviscous", 1e4, 0.0, 2.05 * 1e4**-0.2),
        # L small against M^1/2, so that t is 1; the elastic term adds 2e-5.
        ("elastic-piezoviscous", 1e8, 100.0, 0.99 * 1e8**-0.125 * 100.0**0.75),
    ):
        quantity = f"formula of Moes and Venner, {name}, M = {M:g}, L = {L:g}"
        record("Film", quantity, moes_film(M, L), asymptote, "asymptote of Moes (1992)", relative=1e-4)


@pytest.mark.parametrize(
    ("M", "L", "H"), [(10, 0, 1.324), (20, 0, 1.125), (50, 0, 0.923),
                      (10, 5, 2.826), (20, 5, 2.567), (50, 5, 2.262),
                      (10, 10, 4.103), (20, 10, 3.777), (50, 10, 3.374)],
)  # fmt: skip
def test_moes_fit_is_near_numerical_solutions(M, L, H, record):
    """Against a numerical EHL solution (good to 0.5 %): the fit is off by up to 3.4 %."""
    quantity = "formula of Moes and Venner, smallest film H, M = 10 to 50, L = 0 to 10"
    record("Film", quantity, moes_film(M, L), H, "independent numerical solution", relative=0.04)


@given(film=st.floats(1e-8, 5e-6), steady=st.floats(1e-8, 5e-6), velocity=st.floats(-5.0, 5.0))
def test_film_relaxes_towards_its_steady_value(film, steady, velocity):
    rate = relaxation_rate(film, steady, velocity, C)
    assert rate * (steady - film) >= 0.0
    assert rate == relaxation_rate(film, steady, -velocity, C)


def test_film_is_kept_where_the_entraining_velocity_vanishes():
    contact = CATALOGUE["ehl_contact"]()
    pressed = {"approach": 1e-6, "radius_of_curvature": 0.02}
    assert rates_of(contact, inputs=pressed)["film_thickness"] == 0.0
    for velocity in (1e-3, 1e-6, 1e-9):
        rate = rates_of(contact, inputs={**pressed, "entraining_velocity": velocity})["film_thickness"]
        # u ln(u) tends to zero with u; ln(h/h_ss) stays below 20 here.
        assert abs(rate) < 20 * velocity / C
    assert outputs_of(contact, inputs=pressed)["film_thickness"] == 1e-6


def test_relaxation_time_constant_is_c_h_over_u(record):
    h, u = 1e-6, 2.0
    slope = (relaxation_rate(h * 1.0001, h, u, C) - relaxation_rate(h * 0.9999, h, u, C)) / (2e-4 * h)
    record("Film", "time constant of the film (s)", -1.0 / slope, C * h / u, "C h / u", relative=1e-8)


@pytest.mark.parametrize(("start", "steady"), [(0.3e-6, 1.2e-6), (2e-6, 0.2e-6)])
def test_relaxation_agrees_with_the_exact_implicit_step(start, steady, record):
    """Backward Euler of dh/dt = -(u/C) ln(h/h_ss) has a closed form (Lambert W); first order in its step."""
    u, end = 1.5, 5e-5
    exact = solve_ivp(
        lambda t, h: [relaxation_rate(h[0], steady, u, C)], (0, end), [start], rtol=1e-11, atol=1e-20
    ).y[0, -1]
    errors = []
    for steps in (200, 400, 800):
        h, a = start, u * (end / steps) / C
        for _ in range(steps):
            # a W0[(h_ss/a) exp(h/a)], by logarithms where the exponential overflows.
            h = a * lambert_of_exp(math.log(steady / a) + h / a)
        errors.append(abs(h - exact))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    quantity = "order with which exact implicit steps tend to the film's motion"
    record("Film", quantity, orders, 1.0, "Lambert W against DOP853", tolerance=0.05)
    assert errors[-1] < 2e-3 * abs(start - steady)


def lambert_of_exp(log_argument):
    """W0(exp(x))."""
    if log_argument < 500.0:
        return float(lambertw(math.exp(log_argument)).real)
    w = log_argument - math.log(log_argument)
    for _ in range(20):
        w -= (w + math.log(w) - log_argument) / (1.0 + 1.0 / w)
    return w


def test_range_flags_of_kushwahas_table_3():
    """The table's limits hold on only part of a cycle, and that is said, not clamped."""
    contact = CATALOGUE["ehl_contact"]()
    y = outputs_of(
        contact,
        {"load_is_given": 1.0},
        inputs={"applied_load": 500.0, "entraining_velocity": 2.0, "radius_of_curvature": 0.03},
    )
    E = math.pi / AT["compliance"]
    assert y["material_in_range"] == float(5700 <= 1.8e-8 * E <= 9650)
    assert y["load_in_range"] == float(0.34e-6 <= 500.0 / (E * 0.03 * 12e-3) <= 0.56e-5)
    assert y["speed_in_range"] == float(0.63e-11 <= 0.036 * 2.0 / (E * 0.03) <= 3.3e-11)


@pytest.mark.parametrize(
    ("name", "factor", "speed", "material", "loaded", "modulus"),
    [
        ("kushwaha", 1.67, 0.541, 0.421, 0.059, math.pi),
        ("kushwaha_negative", 1.67, 0.541, 0.421, -0.059, math.pi),
        ("dowson_higginson", 2.65, 0.70, 0.54, -0.13, 2.0),
        ("dowson_toyoda", 3.06, 0.69, 0.56, -0.10, 2.0),
        ("pan_hamrock_minimum", 1.714, 0.694, 0.568, -0.128, 2.0),
        ("pan_hamrock_central", 2.922, 0.692, 0.470, -0.166, 2.0),
    ],
)
def test_films_have_the_constants_of_their_sources(name, factor, speed, material, loaded, modulus):
    """h/R = factor U^speed G^material W^loaded with E = modulus/compliance."""
    a, E = AT, modulus / AT["compliance"]
    U = a["viscosity"] * a["velocity"] / (E * a["radius"])
    W = 500.0 / (E * a["radius"] * a["length"])
    expected = factor * a["radius"] * U**speed * (a["pressure_viscosity"] * E) ** material * W**loaded
    assert film(name) == pytest.approx(expected, rel=1e-12)


def test_a_rigid_contact_under_a_light_load_has_martins_film():
    """h = 4.9 eta u R L/W of an oil of constant viscosity (Martin 1916)."""
    found = film("moes_venner", load=1.0, compliance=1e-16, pressure_viscosity=0.0)
    assert found == pytest.approx(4.9 * 0.036 * 2.0 * 0.03 * 12e-3, rel=1e-3)
