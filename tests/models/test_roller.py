"""The spin of a roller: rolling, slipping, closed forms, and what traction and pin must balance."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from models.catalogue import CATALOGUE

from .systems import outputs_of, rates_of

pytestmark = pytest.mark.plain

ROLLER = CATALOGUE["roller"]()
RADIUS, INERTIA, LIMIT = 9e-3, 8e-7, 0.05
FREE = {"pin_damping": 0.0}


def spin_up(seconds, inputs, start=(0.0, 0.0), **parameters):
    """Times, spin and creep of a roller whose inputs are functions of time."""

    def rate(t, z):
        state = {"absolute_spin": z[0], "creep": z[1]}
        found = rates_of(ROLLER, parameters, state, {name: of(t) for name, of in inputs.items()})
        return [found["absolute_spin"], found["creep"]]

    run = solve_ivp(rate, (0.0, seconds), start, rtol=1e-10, atol=1e-14, method="LSODA", max_step=2e-5)
    assert run.success
    return run.t, run.y[0], run.y[1]


def constant(value):
    return lambda t: value


def test_a_roller_at_rest_slips_until_it_rolls(record):
    """Under the largest traction it rolls after J v/(r (r mu W - T_p)); then it keeps the speed."""
    velocity, load, pin = 2.0, 400.0, 0.02
    inputs = {"rolling_velocity": constant(velocity), "load": constant(load), "pin_torque": constant(pin)}
    times, spin, _ = spin_up(6e-3, inputs, **FREE)
    expected = INERTIA * velocity / (RADIUS * (RADIUS * LIMIT * load - pin))
    slipping = times < 0.9 * expected
    slope = np.polyfit(times[slipping & (times > 1e-4)], spin[slipping & (times > 1e-4)], 1)[0]
    found = velocity / RADIUS / slope
    record("Train", "roller at rest: time until it rolls (s)", found, expected, "closed form", relative=1e-3)
    assert spin[-1] * RADIUS == pytest.approx(velocity, rel=1e-4)


def test_an_unloaded_roller_is_braked_by_its_pin_alone(record):
    """omega = omega_0 exp(-c t/J)."""
    damping, seconds = 2e-5, 0.05
    inputs = {"rolling_velocity": constant(2.0), "load": constant(0.0)}
    _, spin, _ = spin_up(seconds, inputs, (200.0, 0.0), pin_damping=damping)
    expected = 200.0 * math.exp(-damping * seconds / INERTIA)
    record("Train", "unloaded roller: spin after 50 ms (rad/s)", float(spin[-1]), expected, "closed form",
           relative=1e-8)  # fmt: skip


def test_a_loaded_roller_rolls_in_the_limit_of_a_light_one():
    """The slip of a roller that sticks falls with its inertia."""
    omega = 2.0 * math.pi / 0.02
    inputs = {"rolling_velocity": lambda t: 2.0 + 0.5 * math.sin(omega * t), "load": constant(400.0)}
    slips = []
    for inertia in (8e-7, 2e-7, 5e-8):
        times, spin, _ = spin_up(0.02, inputs, (2.0 / RADIUS, 0.0), inertia=inertia, **FREE)
        rolling = 2.0 + 0.5 * np.sin(omega * times)
        slips.append(float(np.sqrt(np.mean((rolling - RADIUS * spin)[times > 0.01] ** 2))))
    assert slips[0] < 1e-3 * 2.0
    assert slips[0] > 3.5 * slips[1] > 3.5 * 3.5 * slips[2]


@settings(max_examples=40, deadline=None)
@given(
    st.floats(-5.0, 5.0), st.floats(0.0, 3000.0), st.floats(-1e3, 1e3), st.floats(-1e-6, 1e-6),
    st.floats(-50.0, 50.0),
)  # fmt: skip
def test_traction_stays_below_its_limit_and_never_drives(velocity, load, spin, creep, turn):
    inputs = {"rolling_velocity": velocity, "load": load, "rotation_rate": turn}
    y = outputs_of(ROLLER, {}, {"absolute_spin": spin, "creep": creep}, inputs)
    assert abs(y["traction"]) <= LIMIT * load * (1.0 + 1e-12)
    assert y["power_loss"] >= 0.0
    assert y["surface_speed"] == pytest.approx(RADIUS * (spin + turn))
    assert y["slip"] * y["traction"] >= 0.0


@pytest.mark.parametrize("turn", [-30.0, 30.0])
def test_a_turning_carrier_does_not_spin_an_unloaded_roller(turn):
    """In space it keeps its spin; about the carrier it has the carrier's speed more."""
    found = rates_of(ROLLER, FREE, {"absolute_spin": 100.0}, {"rotation_rate": turn})
    assert found["absolute_spin"] == 0.0
    assert outputs_of(ROLLER, FREE, {"absolute_spin": 100.0}, {"rotation_rate": turn})["spin"] == 100.0 + turn


@pytest.mark.parametrize(("part", "rolls"), [("tappet", {"follower": 1.0}), ("finger", {"rolls": 1.0})])
@pytest.mark.parametrize("angle", np.radians([90.0, 150.0, 200.0, 260.0]))
def test_a_pad_with_the_rolling_speed_is_a_roller(part, rolls, angle):
    """The same entraining velocity, and nothing slides: where the follower moves as the cam asks."""
    c = CATALOGUE[part]()
    cam = {"cam_angle": float(angle), "cam_speed": 200.0}
    shape = {"follower_radius": 9e-3}
    state = _follow(c, shape, cam)
    pad = {"follower": 2.0} if part == "tappet" else {"rolls": 0.0}
    still = outputs_of(c, shape | pad, state, cam)
    turning = outputs_of(c, shape | pad, state, cam | {"surface_speed": still["rolling_velocity"]})
    roller = outputs_of(c, shape | rolls, state, cam)
    assert turning["sliding_velocity"] == 0.0 == roller["sliding_velocity"]
    assert turning["entraining_velocity"] == pytest.approx(roller["entraining_velocity"], rel=1e-6)
    assert roller["rolling_velocity"] == 0.0


def _follow(c, shape, cam):
    """The state in which the overlap and its rate vanish, along the first two states."""
    pad = {"follower": 2.0} if c.name == "tappet" else {"rolls": 0.0}
    state = {}
    for name, key, low, high in (
        ("overlap", c.state.names[0], -0.05, 0.5),
        ("overlap_rate", c.state.names[1], -1e3, 1e3),
    ):

        def find(value, name=name, key=key):
            return outputs_of(c, shape | pad, {**state, key: value}, cam)[name]

        state[key] = brentq(find, low, high, xtol=1e-16)
    return state
