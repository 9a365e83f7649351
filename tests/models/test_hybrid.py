"""Events: located in time, not missed, chatter carried to its limit, independent of how a step is cut."""

import itertools
import math

import numpy as np
import pytest

from models.core.integrator import NOT_FINITE, OK, TOO_MANY_EVENTS, TOO_MANY_STEPS
from models.core.quantities import Vector
from tests.fmus.native.bouncing_ball import bouncing_ball

from .oscillators import impact_oscillator_orbit

EXACT = 1e-9
BALL = bouncing_ball()
# A one-impact orbit of the harmonic impact oscillator.
OMEGA, R = 2.8, 0.8
PERIOD, ORBIT = 2.0 * math.pi / OMEGA, impact_oscillator_orbit(OMEGA, R, 0.0, -1.0)


def shaken(frequency: float = OMEGA) -> Vector:
    """h'' + h = -cos w t, h >= 0."""
    values = {"gravity": 0.0, "spring": 1.0, "amplitude": 1.0, "restitution": R, "threshold": 1e-12}
    return BALL.parameters.vector({**values, "frequency": frequency})


def falling(restitution: float, threshold: float = 1e-12, gravity: float = 2.0) -> Vector:
    values = {"gravity": gravity, "restitution": restitution, "threshold": threshold}
    return BALL.parameters.vector(values)


def advance(x: Vector, p: Vector, t: float, h: float, push: float = 0.0) -> int:
    c, work, y = BALL, np.zeros(BALL.work_size), np.zeros(BALL.outputs.size)
    U = c.input_polynomial()
    U[0, 0] = push
    return int(c.step(t, h, x, U, p, c.state.nominal, work, np.zeros(1), y))


def test_one_impact_orbit_of_the_harmonic_oscillator() -> None:
    x = BALL.state.vector({"height": 0.0, "velocity": R * ORBIT.velocity})
    start = ORBIT.phase / OMEGA
    # Half a period more than n: the n-th impact is inside. The orbit's multiplier -2.9 limits n.
    assert advance(x, shaken(), start, 3.5 * PERIOD) == OK
    assert x[2] == 3.0
    assert -x[4] == pytest.approx(ORBIT.velocity, abs=EXACT)
    assert x[3] == pytest.approx(start + 3.0 * PERIOD, abs=EXACT)


@pytest.mark.parametrize("restitution", [0.2, 0.9])
def test_bouncing_ball_makes_every_bounce_and_comes_to_rest_at_its_limit(restitution: float) -> None:
    """Dropped from height d: rest at sqrt(2 d/g) (1 + e)/(1 - e), after all bounces above the threshold."""
    x = BALL.state.vector()
    limit = (1.0 + restitution) / (1.0 - restitution)
    assert advance(x, falling(restitution), 0.0, 2.0 * limit) == OK
    assert x[5] == 1.0
    assert x[3] == pytest.approx(limit, abs=1e-10)
    x = BALL.state.vector()
    assert advance(x, falling(restitution, 1e-9), 0.0, 40.0) == OK
    assert x[2] == math.floor(math.log(1e-9 / 2.0) / math.log(restitution)) + 1


def test_rest_converges_with_the_threshold() -> None:
    """Stopped at rebound v, what is missing of the limit is 2 v/((1 - e) g)."""
    for threshold in (1e-3, 1e-6):
        x = BALL.state.vector()
        assert advance(x, falling(0.9, threshold), 0.0, 40.0) == OK
        rebound = -0.9 * x[4]
        assert 19.0 - x[3] == pytest.approx(2.0 * rebound / (0.1 * 2.0), rel=1e-5)


# 1e7 rad/s for 1000 s, about a height of 10 m.
FAST = BALL.parameters.vector({"spring": 1e14})


@pytest.mark.parametrize(
    ("p", "duration", "push", "expected"),
    [
        (falling(0.5, threshold=0.0), 10.0, 0.0, TOO_MANY_EVENTS),
        (FAST, 1e3, 1e15, TOO_MANY_STEPS),
        (falling(0.5), 1.0, math.nan, NOT_FINITE),
    ],
)
def test_steps_that_fail_leave_the_state(p: Vector, duration: float, push: float, expected: int) -> None:
    x = BALL.state.vector()
    before = x.copy()
    assert advance(x, p, 0.0, duration, push) == expected
    assert np.array_equal(x, before)


@pytest.mark.parametrize(("depth", "top"), [(1e-3, 0.02), (1e-6, 0.47), (1e-9, 0.5), (1e-9, 0.97)])
def test_grazing_inside_one_step_is_not_missed(depth: float, top: float) -> None:
    """A parabola that dips `depth` below the ground, both crossings inside one step of the integrator."""
    rise = 20.0
    speed = rise * top
    p = falling(1.0, 0.0, -rise)
    x = BALL.state.vector({"height": 0.5 * speed * top - depth, "velocity": -speed})
    assert advance(x, p, 0.0, 1.0) == OK
    assert x[2] == 1.0
    assert x[3] == pytest.approx(top - math.sqrt(2.0 * depth / rise), abs=1e-10)
    above = BALL.state.vector({"height": 1e-9 + 0.5 * speed * top, "velocity": -speed})
    assert advance(above, p, 0.0, 1.0) == OK
    assert above[2] == 0.0


def test_cutting_a_step_changes_no_impact() -> None:
    p = shaken(2.0)
    horizon, rng = 20.0, np.random.default_rng(1)
    whole = BALL.state.vector()
    assert advance(whole, p, 0.0, horizon) == OK
    for pieces in (2, 7, 60):
        cuts = np.concatenate([[0.0], np.sort(rng.uniform(0.0, horizon, pieces - 1)), [horizon]])
        x = BALL.state.vector()
        for t, end in itertools.pairwise(cuts):
            assert advance(x, p, t, end - t) == OK
        assert x[2] == whole[2] > 5.0
        assert x == pytest.approx(whole, abs=1e-8)


def test_a_wall_passed_by_a_jump_of_its_state_acts_at_once() -> None:
    x = BALL.state.vector({"height": -0.1, "velocity": -1.0})
    assert advance(x, falling(0.5), 3.0, 1e-3) == OK
    assert x[2] == 1.0
    assert x[3] == 3.0
