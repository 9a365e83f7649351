"""Friction of pivots: laws of Coulomb's friction, sticking, hysteresis, and what no friction may do."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from models.catalogue import CATALOGUE

from .systems import outputs_of, rates_of

PIVOT = CATALOGUE["pivot_friction"]()
INERTIA, LOAD = 1e-4, 1000.0
LIMIT = 0.1 * 8e-3 * LOAD
YIELD = LIMIT / 5e3


def swing(moment, seconds, start=(0.0, 0.0, 0.0), load=lambda t: LOAD, **parameters):
    """(times, rotation, its rate, twist) of a lever on the pivot under a moment (N m) of time."""

    def rate(t, z):
        state, inputs = {"twist": z[2]}, {"rotation_rate": z[1], "load": load(t)}
        torque = outputs_of(PIVOT, parameters, state, inputs)["friction_torque"]
        return [z[1], (moment(t) - torque) / INERTIA, rates_of(PIVOT, parameters, state, inputs)["twist"]]

    run = solve_ivp(rate, (0.0, seconds), start, rtol=1e-9, atol=1e-12, method="LSODA", max_step=1e-4)
    assert run.success
    return run.t, run.y[0], run.y[1], run.y[2]


def drag(rotation, rates, twist=0.0, load=LOAD, **parameters):
    """Friction torques at the points of a `rotation` (rad) that has constant rates between them."""
    torques = []
    for (a, b), rate in zip(pairwise(rotation), rates, strict=True):
        inputs = {"rotation_rate": rate, "load": load}

        def twisting(t, z, inputs=inputs):
            return [rates_of(PIVOT, parameters, {"twist": z[0]}, inputs)["twist"]]

        run = solve_ivp(twisting, (0.0, (b - a) / rate), [twist], rtol=1e-9, atol=1e-12, method="LSODA")
        twist = float(run.y[0][-1])
        torques.append(outputs_of(PIVOT, parameters, {"twist": twist}, inputs)["friction_torque"])
    return np.array(torques)


def test_a_lever_coasts_as_coulomb_says(record):
    """omega^2 = 2 T_c phi/J: it stops after J omega^2/(2 T_c) and stays there."""
    start = 40.0
    _, rotation, rate, _ = swing(lambda t: 0.0, 0.05, (0.0, start, YIELD))
    expected = INERTIA * start**2 / (2.0 * LIMIT)
    # Where it stops, the twist is given back.
    source = "closed form, less the elastic twist"
    quantity = "lever on a dry pivot: angle until it stands (rad)"
    record("Train", quantity, float(rotation[-1]), expected - YIELD, source, relative=1e-3)
    assert abs(rate[-1]) < 1e-3 * start


def test_viscous_friction_adds_to_the_dry_one(record):
    """J omega' = -T_c - c omega: it stops at t = J/c ln(1 + c omega/T_c)."""
    start, viscous = 40.0, 0.02
    times, _, rate, _ = swing(lambda t: 0.0, 0.01, (0.0, start, YIELD), viscous_coefficient=viscous)
    first = int(np.argmax(rate <= 0.0))
    stops = float(np.interp(0.0, -rate[first - 1 : first + 1], times[first - 1 : first + 1]))
    expected = INERTIA / viscous * math.log1p(viscous * start / LIMIT)
    record("Train", "lever on a dry and viscous pivot: time until it stands (s)", stops, expected,
           "closed form", relative=2e-3)  # fmt: skip


@pytest.mark.parametrize("share", [0.3, 0.95])
def test_a_steady_moment_below_the_limit_holds_the_lever(share):
    """It twists by M/k and then rests for ever; above the limit it goes."""
    moment = share * LIMIT
    _, rotation, rate, twist = swing(lambda t: moment * min(1.0, t / 0.02), 0.3)
    assert twist[-1] == pytest.approx(moment / 5e3, rel=1e-6)
    assert rotation[-1] == pytest.approx(twist[-1], rel=0.2)
    assert abs(rate[-1]) < 1e-6
    later = swing(lambda t: moment, 0.5, (rotation[-1], 0.0, twist[-1]))[1]
    assert later[-1] == pytest.approx(rotation[-1], abs=1e-3 * YIELD)
    _, _, rate, _ = swing(lambda t: 1.2 * LIMIT, 0.05)
    assert rate[-1] == pytest.approx(0.2 * LIMIT / INERTIA * 0.05, rel=0.02)


def test_a_vibrating_moment_does_not_creep():
    """60 cycles between 0.02 and 0.98 of the limit: the mean rotation stays."""
    moment = 0.5 * LIMIT
    times, rotation, _, _ = swing(
        lambda t: moment * min(1.0, t / 0.01) * (1.0 + 0.96 * math.sin(2.0 * math.pi * 200.0 * t)), 0.7
    )

    def mean(a, b):
        within = (times >= a) & (times < b)
        return np.trapezoid(rotation[within], times[within]) / (b - a)

    # The start dies out by 1e-4; what creeps is to stay below 4e-6 in a cycle.
    assert mean(0.5, 0.7) == pytest.approx(mean(0.2, 0.4), abs=2.4e-4 * YIELD)


def test_a_stuck_pivot_that_loses_its_load_lets_go():
    """A moment of 0.7 T_c holds until the load has fallen to 0.7 of it."""
    moment = 0.7 * LIMIT
    times, rotation, rate, _ = swing(
        lambda t: moment,
        0.06,
        (moment / 5e3, 0.0, moment / 5e3),
        load=lambda t: LOAD * (1.0 - min(0.5, max(0.0, 10.0 * (t - 0.01)))),
    )
    held = times < 0.04
    assert np.max(np.abs(rotation[held] - rotation[0])) < 0.1 * YIELD
    assert rate[-1] > 1.0


def test_the_loop_of_a_swing_loses_coulombs_work(record):
    """Turned to and fro by A, slowly: 4 T_c (A - z_c)."""
    amplitude, points = 10.0 * YIELD, 400
    along = np.linspace(-amplitude, amplitude, points)
    path = np.r_[np.linspace(0.0, amplitude, points), along[::-1][1:], along[1:]]
    rates = np.sign(np.diff(path)) * 0.5
    torque = np.r_[0.0, drag(path, rates, relaxation_time=1e-6)]
    loop = slice(points - 1, None)
    work = float(np.trapezoid(torque[loop], path[loop]))
    expected = 4.0 * LIMIT * (amplitude - YIELD)
    record("Train", "dry pivot turned to and fro: work of a loop (J)", work, expected,
           "closed form", relative=1e-3)  # fmt: skip


@settings(max_examples=20, deadline=None)
@given(st.floats(0.2, 30.0), st.floats(-0.5, 0.5))
def test_dry_friction_does_not_know_the_speed(factor, twist):
    """The same path of rotation at another speed has the same torques."""
    path = YIELD * np.array([0.0, 0.4, 0.9, 1.3, 0.8, -0.5, -1.6, 0.0])
    rates = np.sign(np.diff(path))
    slow = drag(path, rates, twist * YIELD, relaxation_time=1e-10)
    fast = drag(path, factor * rates, twist * YIELD, relaxation_time=1e-10)
    assert fast == pytest.approx(slow, abs=1e-4 * LIMIT)


@pytest.mark.parametrize("name", ["rocker", "finger"])
def test_levers_feel_the_torque_of_their_pivot(name):
    """J b'' loses what the pivot takes; a large mass holds the finger's pivot."""
    lever = CATALOGUE[name]()
    heavy = {"mass": 1e9, "inertia": 1e6, "mass_arm": 0.0} if name == "finger" else {"inertia": 1e6}
    free = rates_of(lever, heavy, {"rotation_rate": 3.0}, {})
    held = rates_of(lever, heavy, {"rotation_rate": 3.0}, {"pivot_torque": 2.0})
    assert 1e6 * (free["rotation_rate"] - held["rotation_rate"]) == pytest.approx(2.0, rel=1e-6)
    assert outputs_of(lever, {}, {"rotation_rate": 3.0}, {})["rotation_rate"] == 3.0


@settings(max_examples=40, deadline=None)
@given(st.floats(-1.0, 1.0), st.floats(0.0, 3000.0), st.floats(-1e-4, 1e-4))
def test_a_pad_is_a_pivot_with_a_radius_of_a_metre(velocity, load, creep):
    pad = CATALOGUE["pad_friction"]()
    laws = {"friction_coefficient": 0.1, "sticking_stiffness": 1e7, "relaxation_time": 3e-5}
    laws |= {"viscous_coefficient": 2.0}
    moving = {"sliding_velocity": velocity, "load": load}
    turning = {"rotation_rate": velocity, "load": load}
    slides = outputs_of(pad, laws, {"creep": creep}, moving)
    turns = outputs_of(PIVOT, laws | {"radius": 1.0}, {"twist": creep}, turning)
    names = {"friction_force": "friction_torque", "slip": "sliding_rate"}
    for name in ("friction_force", "sticking_margin", "slip", "power_loss"):
        assert slides[name] == pytest.approx(turns[names.get(name, name)], rel=1e-12, abs=1e-12)
    rates = rates_of(pad, laws, {"creep": creep}, moving)["creep"]
    assert rates == rates_of(PIVOT, laws | {"radius": 1.0}, {"twist": creep}, turning)["twist"]
