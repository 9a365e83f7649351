"""The constrained form: the loads of Kushwaha's valve train, its films, and its limit of a stiff contact."""

import math

import numpy as np
import pytest

from models.core.difference import difference
from models.core.system import ModelError
from models.monolithic import equilibrium
from models.monolithic.problem import SystemProblem
from reproduction.adherence import AdherenceProblem, solve_adherence
from tests.models.systems import DRY, column, march_alone, run, turn, valve_train

SAMPLES = 3600
# Turns after which surge (and the shaft's modes) have decayed by 1e-6: damping 64 1/s.
TURNS = {600: 3, 1000: 5, 3000: 13}


def last_turn(speed_rpm, turns):
    return np.linspace(turns - 1, turns, SAMPLES + 1) * turn(speed_rpm)


def adherence(speed_rpm, massless=False, **parts):
    """Outputs over the last turn, by name."""
    system = valve_train(speed_rpm, **parts)
    turns = 1 if massless else TURNS[speed_rpm]
    problem = AdherenceProblem(system, massless)
    times = last_turn(speed_rpm, turns)
    rows = march_alone(problem, equilibrium(system), times, tolerance=1e-8)
    _, _, outputs = problem.observe(times, rows)
    return lambda name: column(problem.system, outputs, name)


FLEXIBLE = {"flexible": 1.0}


def test_massless_load_is_the_closed_form(record):
    """W = m3 s'' w^2 + f_p + k0 s."""
    at = adherence(3000, massless=True)
    base = 2.610272395869072 * 8e-3
    bend = at("camshaft.radius_of_curvature") - base - at("camshaft.cam_lift")
    exact = 0.22 * bend * (100.0 * math.pi) ** 2 + 330.0 + 35e3 * at("camshaft.cam_lift")
    # Rounding of the relative acceleration, 1e4 m/s^2 times the mass.
    quantity = "load of the cam (N), massless spring, 3000 r/min"
    record("Contact", quantity, at("contact.load"), exact, "m3 s'' ω² + f_p + k0 s", tolerance=1e-9)


@pytest.mark.parametrize(
    ("shaft", "speed_rpm", "low", "high"),
    [
        ("flexible", 600, 326.84, 606.42),
        pytest.param("flexible", 1000, 323.39, 607.40, marks=pytest.mark.long),
        pytest.param("rigid", 600, 329.97, 610.04, marks=pytest.mark.long),
        pytest.param("rigid", 1000, 329.76, 610.20, marks=pytest.mark.long),
        pytest.param("rigid", 3000, 97.12, 838.52, marks=pytest.mark.long),
    ],
)
def test_load_with_surge(shaft, speed_rpm, low, high, record):
    """To 1e-4, or to the last digit stated."""
    load = adherence(speed_rpm, camshaft={"flexible": float(shaft == "flexible")})("contact.load")
    for name, value, stated in (("smallest", load.min(), low), ("largest", load.max(), high)):
        quantity = f"{name} load of the cam (N), {shaft} camshaft, surge, {speed_rpm} r/min"
        tolerance = max(1e-4 * stated, 0.005)
        record("Contact", quantity, value, stated, "independent Runge-Kutta code", tolerance=tolerance)


def test_film_numbers_at_1000_rpm(record):
    at = adherence(1000)
    per_degree = SAMPLES // 360
    steady, film = at("contact.steady_film_thickness") * 1e6, at("contact.film_thickness") * 1e6
    cases = [("film", 144, 0.139), ("film", 168, 0.127), ("film", 192, 0.148), ("film", 216, 0.120)]
    cases += [("film", 120, 1.224), ("film without squeeze", 120, 1.219)]
    for name, degrees, stated in cases:
        value = (film if name == "film" else steady)[degrees * per_degree]
        quantity = f"{name} at {degrees}° (µm), formula of Kushwaha et al. (2000), 1000 r/min"
        # 1 per cent, as the table's last digit.
        record("Film", quantity, value, stated, "independent Runge-Kutta code", relative=0.01)


def compliant_difference(stiffness):
    """Relative RMS difference of the load at 3000 r/min, compliant against adherence, without film."""
    # Damping grows with the root of the stiffness: the contact mode's ratio stays 0.05.
    scaled = {
        "youngs_modulus_1": 207e9 * stiffness,
        "youngs_modulus_2": 207e9 * stiffness,
        "contact_damping": 920.0 * math.sqrt(stiffness),
    }
    system = valve_train(3000, contact={**DRY, **scaled})
    # The load of the stiffest is 64 times the position's error: 1e-9 is off by half a per cent, this by 5e-4.
    outputs = run(SystemProblem(system), equilibrium(system), last_turn(3000, TURNS[3000]), tolerance=1e-10)
    held = adherence(3000, contact=DRY)("contact.load")
    return difference(column(system, outputs, "contact.load"), held).relative_rms


@pytest.mark.parametrize(
    ("stiffness", "linear"),
    [(4, 4.6e-3), *(pytest.param(*one, marks=pytest.mark.long) for one in ((16, 1.5e-3), (64, 5.2e-4)))],
)
def test_the_compliant_contact_tends_to_adherence_as_it_stiffens(stiffness, linear):
    """At 3000 r/min; a linear contact of as many times 3.85e8 N/m comes within an eighth."""
    assert compliant_difference(stiffness) == pytest.approx(linear, rel=0.125)


def test_two_methods_agree():
    times = np.linspace(0.5, 1.0, 361) * turn(1000)
    found = solve_adherence(valve_train(1000), times, tolerance=1e-7)
    # The load's digits below the tolerance are lost to the accelerations, 1e3 times the positions.
    assert found.uncertainty["contact.load"].relative_rms < 1e-6
    assert found.uncertainty["contact.film_thickness"].relative_rms < 1e-7


def test_uncertainty_scales_with_the_tolerance_and_is_the_error():
    """The second method's error is below the first's, whose steps add up to 1 to 2 tolerances."""
    times = np.linspace(0.5, 1.0, 361) * turn(1000)
    sharp = solve_adherence(valve_train(1000), times, tolerance=1e-10)["contact.film_thickness"]
    for tolerance in (1e-6, 1e-7, 1e-8):
        found = solve_adherence(valve_train(1000), times, tolerance=tolerance)
        stated = found.uncertainty["contact.film_thickness"]
        assert stated.relative_rms < 3.0 * tolerance
        error = difference(found["contact.film_thickness"], sharp)
        assert error.rms < 1.5 * stated.rms


@pytest.mark.long
def test_drive_work_is_what_the_spring_dissipates_and_stores():
    times = np.linspace(0.0, turn(1000), 181)
    found = solve_adherence(valve_train(1000, camshaft=FLEXIBLE), times, tolerance=1e-8)
    # A drift of 1e-8 per step and nominal over some thousand steps of an energy of 4 J.
    residual = found.stored_energy - found.stored_energy[0] + found.dissipated - found.supplied
    assert np.max(np.abs(residual)) < 1e-6


def test_exactly_one_valve_train():
    system = valve_train(1000)
    del system.instances["contact"]
    with pytest.raises(ModelError, match="0 components ehl_contact: must be exactly 1"):
        AdherenceProblem(system)
