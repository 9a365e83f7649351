"""Friction of pins, needles, guides, spinning tappets and rolling contacts: closed forms and balances."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from models.catalogue import CATALOGUE
from models.contact.analysis.bearing.steady import solve_steady as solve_bearing
from models.contact.analysis.line.line_contact import LineContact
from models.contact.analysis.line.steady import solve_steady as solve_film
from models.contact.films.groups import Conditions
from models.contact.fluid import Lubricant
from models.contact.hertz import elastic_compliance
from models.contact.oil_grades import GRADES
from models.contact.oils import ZERO_CELSIUS, evaluate_oil
from models.contact.rolling import rolling_friction

from .systems import outputs_of, rates_of

STEEL = elastic_compliance(207e9, 0.3, 207e9, 0.3)
PIN, NEEDLES, GUIDE, SPIN = (
    CATALOGUE[name]() for name in ("pin_bearing", "needle_bearing", "guide_friction", "tappet_spin")
)
RADIUS, WIDTH, CLEARANCE = 4e-3, 8e-3, 15e-6
TURNING = 400.0


def settle(load, rate=TURNING, **parameters):
    """Outputs of a pin after its film has become steady, and its start after that."""
    inputs = {"applied_load": load, "rotation_rate": rate}
    names = PIN.state.names

    def move(t, z):
        found = rates_of(PIN, parameters, dict(zip(names, z, strict=True)), inputs)
        return [found[name] for name in names]

    start = [1e-7, 1e-7, 0.0]
    run = solve_ivp(move, (0.0, 3.0), start, method="LSODA", rtol=1e-8, atol=1e-14)
    assert run.success
    state = dict(zip(names, run.y[:, -1], strict=True))
    return outputs_of(PIN, parameters, state, inputs)


@pytest.mark.plain
def test_a_pin_without_load_is_petroffs(record):
    """2 pi mu R^3 L omega/c, and at both faces pi mu omega (R_F^4 - R^4)/h_F."""
    inputs = {"rotation_rate": TURNING}
    film = 2.0 * math.pi * 0.01 * RADIUS**3 * WIDTH * TURNING / CLEARANCE
    found = outputs_of(PIN, {}, {}, inputs)["friction_torque"]
    record("Train", "pin without load: torque (N m)", found, film, "Petroff", relative=1e-14)
    faces = math.pi * 0.01 * TURNING * (7e-3**4 - RADIUS**4) / 1e-4
    with_faces = outputs_of(PIN, {"face_gap": 1e-4}, {}, inputs)["friction_torque"]
    assert with_faces - film == pytest.approx(faces, rel=1e-10)


def test_a_steady_pin_has_the_friction_of_reynolds_equation(record):
    """Torque over W c, and S, of a finite bearing with p >= 0 at eps = 0.6 and L/D = 1."""
    exact = solve_bearing(0.6, 1.0)
    load = 0.01 * TURNING / (2.0 * math.pi) * WIDTH * 2.0 * RADIUS * (RADIUS / CLEARANCE) ** 2
    load /= exact.sommerfeld
    found = settle(load)
    # The table's film, to 0.1 % where it is thinnest.
    record("Train", "pin under a steady load: eccentricity", found["eccentricity_ratio"], 0.6,
           "Reynolds' equation", relative=1e-3)  # fmt: skip
    record("Train", "pin under a steady load: torque (N m)", found["friction_torque"],
           exact.friction * load * CLEARANCE, "Reynolds' equation", relative=2e-3)  # fmt: skip


def test_friction_of_a_pin_has_stribecks_minimum():
    """Over speed it falls from mu_b W R, and grows again as a film carries the load."""
    load, rates = 600.0, np.geomspace(0.1, 3000.0, 10)
    every = [settle(load, rate, sticking_stiffness=5e4) for rate in rates]
    torques = np.array([found["friction_torque"] for found in every])
    least = int(np.argmin(torques))
    assert 0 < least < len(rates) - 1
    assert (np.diff(torques[: least + 1]) < 0.0).all()
    assert (np.diff(torques[least:]) > 0.0).all()
    assert torques[0] == pytest.approx(0.1 * load * RADIUS, rel=0.02)
    # The asperities have carried nearly all, and carry next to nothing at the minimum.
    shares = [found["asperity_load"] / load for found in every]
    assert shares[0] > 0.95
    assert shares[least] < 0.1


def test_heat_takes_friction_from_the_film_and_gives_it_to_the_asperities():
    oils = [evaluate_oil(GRADES["SAE 5W-30"], ZERO_CELSIUS + t) for t in (40.0, 90.0, 130.0)]
    every = [settle(1500.0, viscosity=oil.viscosity) for oil in oils]
    rubbed = [found["asperity_torque"] for found in every]
    sheared = [found["friction_torque"] - found["asperity_torque"] for found in every]
    assert sheared == sorted(sheared, reverse=True)
    assert rubbed == sorted(rubbed)
    assert rubbed[-1] > rubbed[0]


def test_a_steady_roller_loses_what_its_cam_gives(record):
    """T v = slip + pin + F_R r omega, of roller and pin together; the traction is T = (T_p + r F_R)/r."""
    roller, velocity, load, drag = CATALOGUE["roller"](), 4.0, 800.0, 0.5
    names = [*roller.state.names, *PIN.state.names]
    free = {"pin_damping": 0.0}

    def show(z):
        state = dict(zip(names, z, strict=True))
        rolling = {name: state[name] for name in roller.state.names}
        pinned = {name: state[name] for name in PIN.state.names}
        turning = {"rotation_rate": state["absolute_spin"], "applied_load": load}
        pin = outputs_of(PIN, {}, pinned, turning)
        inputs = {
            "rolling_velocity": velocity, "load": load, "rolling_friction": drag,
            "pin_torque": pin["friction_torque"],
        }  # fmt: skip
        rates = rates_of(roller, free, rolling, inputs) | rates_of(PIN, {}, pinned, turning)
        return outputs_of(roller, free, rolling, inputs), pin, [rates[name] for name in names]

    start = [velocity / 9e-3, 0.0, 1e-7, 1e-7, 0.0]
    run = solve_ivp(lambda t, z: show(z)[2], (0.0, 1.0), start, method="LSODA", rtol=1e-9, atol=1e-13)
    found, pin, _ = show(run.y[:, -1])
    lost = found["power_loss"] + pin["power_loss"] + drag * found["surface_speed"]
    record("Train", "roller on its pin: power of the cam (W)", found["traction"] * velocity, lost,
           "sum of the losses", relative=1e-6)  # fmt: skip
    assert found["traction"] == pytest.approx(pin["friction_torque"] / 9e-3 + drag, rel=1e-6)


@pytest.mark.plain
def test_needles_have_palmgrens_torque():
    """1e-7 f_0 (nu n)^(2/3) d_m^3 + f_1 F d_m, in N mm."""
    inputs = {"rotation_rate": TURNING, "load": 800.0}
    nu, rpm = 1e6 * 0.01 / 800.0, TURNING * 30.0 / math.pi
    expected = 1e-7 * 5.0 * (nu * rpm) ** (2.0 / 3.0) * 10.0**3 + 5e-4 * 800.0 * 10.0
    limit = 5e-4 * 800.0 * 0.01 + 160e-10 * 5.0 * 10.0**3
    found = outputs_of(NEEDLES, {}, {"twist": limit / 50.0}, inputs)
    assert 1e3 * found["friction_torque"] == pytest.approx(expected, rel=1e-12)
    assert found["power_loss"] == pytest.approx(found["friction_torque"] * TURNING, rel=1e-12)
    slow = outputs_of(NEEDLES, {}, {"twist": 1.0}, {"rotation_rate": 1.0, "load": 800.0})
    assert 1e3 * slow["friction_torque"] == pytest.approx(160e-7 * 5.0 * 10.0**3 + 4.0, rel=1e-12)


@pytest.mark.plain
@settings(max_examples=50, deadline=None)
@given(st.floats(-500.0, 500.0), st.floats(-5.0, 5.0), st.floats(-0.02, 0.05))
def test_a_guide_holds_its_body(force, moment, overhang):
    """Its ends take force and moment together, and rub by mu of their sum."""
    inputs = {"side_force": force, "side_moment": moment, "velocity": 1.0}
    found = outputs_of(GUIDE, {"overhang": overhang, "viscosity": 1e-3}, {"creep": 1.0}, inputs)
    near, far = found["near_load"], found["far_load"]
    assert near + far == pytest.approx(force, abs=1e-9)
    assert near * overhang + far * (overhang + 40e-3) == pytest.approx(moment, abs=1e-9)
    dry = found["friction_force"] - found["viscous_friction"]
    assert dry == pytest.approx(0.1 * (abs(near) + abs(far)), rel=1e-9, abs=1e-9)


@pytest.mark.plain
def test_a_guide_without_side_load_is_petroffs(record):
    found = outputs_of(GUIDE, {}, {}, {"velocity": 2.0})["friction_force"]
    expected = math.pi * 0.01 * 6e-3 * 40e-3 / 20e-6 * 2.0
    record("Train", "guide without side load: friction (N)", found, expected, "Petroff", relative=1e-14)


def free_spin(offset, length, place):
    """The spin at which the cam's friction gives no torque."""

    def torque(spin):
        parameters = {"axial_offset": offset, "length": length}
        inputs = {"sliding_velocity": 2.5, "contact_offset": place, "friction_force": 30.0}
        return outputs_of(SPIN, parameters, {"spin": spin}, inputs)["spin_torque"]

    return brentq(torque, 0.0, 2.6 / offset, xtol=1e-9)


@pytest.mark.plain
def test_a_free_tappet_spins_as_its_contact_line_lets_it(record):
    """At a point u_s e/(e^2 + x^2); under a line in the middle u_s/sqrt(e^2 + L^2/4)."""
    e, x = 1.5e-3, 6e-3
    found, expected = free_spin(e, 1e-6, x), 2.5 * e / (e**2 + x**2)
    record("Train", "free tappet under a point: spin (rad/s)", found, expected, "closed form", relative=1e-6)
    e, length = 4e-3, 5e-3
    found, expected = free_spin(e, length, 1e-9), 2.5 / math.hypot(e, 0.5 * length)
    # The direction of the friction jumps between two of eight points, an eighth of the line apart.
    assert found == pytest.approx(expected, rel=0.5 * length / 8.0 / e)


@pytest.mark.plain
@settings(max_examples=30, deadline=None)
@given(st.floats(0.0, 6e-3), st.floats(-12e-3, 12e-3), st.floats(0.1, 5.0))
def test_a_tappet_that_does_not_spin_feels_all_the_friction(offset, place, sliding):
    """F_x = F, and T = F e."""
    inputs = {"sliding_velocity": sliding, "contact_offset": place, "friction_force": 30.0}
    still = outputs_of(SPIN, {"axial_offset": offset}, {}, inputs)
    assert still["cam_friction"] == pytest.approx(30.0, rel=1e-14)
    assert still["spin_torque"] == pytest.approx(30.0 * offset, rel=1e-12)


@pytest.mark.parametrize(
    ("load", "velocity", "radius", "viscosity"),
    [(600.0, 5.0, 6e-3, 9e-3), (1200.0, 5.0, 6e-3, 9e-3), (600.0, 1.5, 0.03, 0.036)],
)
def test_rolling_friction_is_that_of_a_solved_film(load, velocity, radius, viscosity, record):
    """L int h/2 dp of the field: Goksem and Hargreaves' inlet theory is 10 to 20 % below it.

    Measured 9.5, 18.0 and 19.9 % below: what the contact adds to the inlet sets the tolerance of 20 %.
    """
    length, alpha = 12e-3, 1.8e-8
    film = solve_film(LineContact(load, velocity, radius, length, STEEL, Lubricant(viscosity, alpha)))
    solved = length * float(np.sum(0.25 * (film.film[1:] + film.film[:-1]) * np.diff(film.pressure)))
    found = rolling_friction(load, Conditions(velocity, radius, length, STEEL, viscosity, alpha), 0.0)
    name = f"rolling friction at {load:g} N, {velocity:g} m/s, {1e3 * radius:g} mm (N)"
    record("Contact", name, found, solved, "solved film", relative=0.2)


@pytest.mark.plain
def test_rolling_friction_hardly_knows_the_load_and_falls_with_heat():
    def at(load=600.0, velocity=5.0, heat=0.0):
        return rolling_friction(load, Conditions(velocity, 6e-3, 12e-3, STEEL, 9e-3, 1.6e-8), heat)

    assert at(1200.0) == pytest.approx(at() * 2.0**0.0126, rel=1e-12)
    assert at(velocity=-5.0) == -at()
    assert at(velocity=10.0) == pytest.approx(at() * 2.0**0.658, rel=1e-12)
    assert at(0.0) == at(velocity=0.0) == 0.0
    assert at() > at(heat=0.1) > at(heat=1.0) > 0.0


@pytest.mark.plain
@pytest.mark.parametrize("name", ["tappet", "finger"])
def test_rolling_friction_takes_its_power_from_shaft_and_roller(name):
    """F_R (u_1 + u_2), of which the shaft's part is F_R times rolling_speed."""
    follower = CATALOGUE[name]()
    inputs = {"cam_angle": 2.5, "cam_speed": 120.0, "surface_speed": 1.5}
    parameters = {"follower": 2.0} if name == "tappet" else {}
    free = outputs_of(follower, parameters, {}, inputs)
    held = outputs_of(follower, parameters, {}, {**inputs, "rolling_friction": 3.0})
    power = (held["cam_torque"] - free["cam_torque"]) * 120.0
    assert power == pytest.approx(3.0 * free["rolling_speed"], rel=1e-12)
    assert free["rolling_speed"] + 1.5 == pytest.approx(2.0 * free["entraining_velocity"], rel=1e-12)
