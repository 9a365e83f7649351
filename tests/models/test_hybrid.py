"""Events: located in time, not missed, chatter carried to its limit, independent of how a step is cut."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
import pytest

from models.compile.kernel import kernel
from models.core.component import Component, Events
from models.core.integrator import NOT_FINITE, OK, TOO_MANY_EVENTS, TOO_MANY_STEPS
from models.core.quantities import Quantity, Vector, layouts

from .oscillators import impact_oscillator_orbit

EXACT = 1e-9


@dataclass
class Parameters:
    spring: float = Quantity("N/m", "spring rate").default(1.0)
    amplitude: float = Quantity("N", "excitation").default(1.0)
    frequency: float = Quantity("rad/s", "its frequency").default(2.8)
    weight: float = Quantity("N", "constant force towards the wall").default()
    wall: float = Quantity("m", "position of the wall").default()
    restitution: float = Quantity("1", "coefficient of restitution").default(0.8)
    threshold: float = Quantity("m/s", "rebound below which it rests").default(1e-12)


@dataclass
class State:
    position: float = Quantity("m", "position").default()
    velocity: float = Quantity("m/s", "velocity").default()
    impacts: float = Quantity("1", "impacts", count=True).default()
    time: float = Quantity("s", "time of the last impact").default()
    approach: float = Quantity("m/s", "velocity before it").default()
    resting: float = Quantity("1", "at rest on the wall", boolean=True).default()


@dataclass
class Inputs:
    push: float = Quantity("N", "added force").default()


@dataclass
class Outputs:
    position: float = Quantity("m", "position").default()


def impact_oscillator() -> Component:
    """x'' + k x = A cos w t + weight, x <= wall; with k = A = 0 a ball that falls upwards."""

    @kernel
    def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
        dx.position = 0.0
        dx.velocity = 0.0
        dx.impacts = 0.0
        dx.time = 0.0
        dx.approach = 0.0
        dx.resting = 0.0
        if x.resting == 0.0:
            force = p.amplitude * math.cos(p.frequency * t) + p.weight + u.push
            dx.position = x.velocity
            dx.velocity = force - p.spring * x.position

    @kernel
    def guards(t: float, x: State, u: Inputs, p: Parameters, g: Vector) -> None:
        g[0] = p.wall - x.position if x.resting == 0.0 else 1.0

    @kernel
    def transition(k: int, t: float, x: State, u: Inputs, p: Parameters) -> None:
        x.position = p.wall
        x.impacts += 1.0
        x.time = t
        x.approach = x.velocity
        x.velocity = -p.restitution * x.velocity
        if abs(x.velocity) < p.threshold:
            x.velocity = 0.0
            x.resting = 1.0

    @kernel
    def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
        y.position = x.position

    @kernel
    def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
        e[:] = 0.0

    return Component(
        name="impact_oscillator",
        description="Harmonic impact oscillator",
        **layouts(Parameters, State, Inputs, Outputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={},
        events=Events(1, guards, transition),
    )


OSCILLATOR = impact_oscillator()
# Its one-impact orbit at the default parameters.
OMEGA, R = 2.8, 0.8
PERIOD, ORBIT = 2.0 * math.pi / OMEGA, impact_oscillator_orbit(OMEGA, R, 0.0, -1.0)


def advance(x: Vector, p: Vector, t: float, h: float, push: float = 0.0) -> int:
    c = OSCILLATOR
    U = c.input_polynomial()
    U[0, 0] = push
    return int(c.step(t, h, x, U, p, c.state.nominal, np.zeros(c.work_size), np.zeros(1), np.zeros(1)))


def test_one_impact_orbit_of_the_harmonic_oscillator() -> None:
    x, p = OSCILLATOR.state.vector({"velocity": -R * ORBIT.velocity}), OSCILLATOR.parameters.vector()
    start = ORBIT.phase / OMEGA
    # Half a period more than n: the n-th impact is inside. The orbit's multiplier -2.9 limits n.
    assert advance(x, p, start, 3.5 * PERIOD) == OK
    assert x[2] == 3.0
    assert x[4] == pytest.approx(ORBIT.velocity, abs=EXACT)
    assert x[3] == pytest.approx(start + 3.0 * PERIOD, abs=EXACT)


def test_multipliers_of_that_orbit() -> None:
    """Determinant r^2 and trace, by differences of the map from impact to impact."""

    def section(delta: float, slower: float) -> Vector:
        """Impact time (mod period) and speed before it, from those of the impact before."""
        x = OSCILLATOR.state.vector({"velocity": -R * (ORBIT.velocity + slower)})
        assert advance(x, OSCILLATOR.parameters.vector(), ORBIT.phase / OMEGA + delta, 1.5 * PERIOD) == OK
        return np.array([x[3] - PERIOD, x[4]])

    d = 1e-6
    columns = [(section(*e) - section(*-e)) / (2.0 * d) for e in (np.array([d, 0.0]), np.array([0.0, d]))]
    matrix = np.column_stack(columns)
    assert np.linalg.det(matrix) == pytest.approx(R**2, abs=1e-7)
    assert np.trace(matrix) == pytest.approx(ORBIT.trace, abs=1e-6)


def falling(restitution: float, threshold: float = 1e-12) -> Vector:
    values = {"spring": 0.0, "amplitude": 0.0, "weight": 2.0, "restitution": restitution}
    return OSCILLATOR.parameters.vector({**values, "threshold": threshold})


@pytest.mark.parametrize("restitution", [0.2, 0.9])
def test_bouncing_ball_makes_every_bounce_and_comes_to_rest_at_its_limit(restitution: float) -> None:
    """Dropped from height d: rest at sqrt(2 d/g) (1 + e)/(1 - e), after all bounces above the threshold."""
    x = OSCILLATOR.state.vector({"position": -1.0})
    limit = (1.0 + restitution) / (1.0 - restitution)
    assert advance(x, falling(restitution), 0.0, 2.0 * limit) == OK
    assert x[5] == 1.0
    assert x[3] == pytest.approx(limit, abs=1e-10)
    x = OSCILLATOR.state.vector({"position": -1.0})
    assert advance(x, falling(restitution, 1e-9), 0.0, 40.0) == OK
    assert x[2] == math.floor(math.log(1e-9 / 2.0) / math.log(restitution)) + 1


def test_rest_converges_with_the_threshold() -> None:
    """Stopped at rebound v, what is missing of the limit is 2 v/((1 - e) g)."""
    for threshold in (1e-3, 1e-6):
        x = OSCILLATOR.state.vector({"position": -1.0})
        assert advance(x, falling(0.9, threshold), 0.0, 40.0) == OK
        rebound = 0.9 * x[4]
        assert 19.0 - x[3] == pytest.approx(2.0 * rebound / (0.1 * 2.0), rel=1e-5)


# 1e7 rad/s for 1000 s, far from the wall.
FAST = OSCILLATOR.parameters.vector({"spring": 1e14, "wall": 10.0})


@pytest.mark.parametrize(
    ("p", "duration", "push", "expected"),
    [
        (falling(0.5, threshold=0.0), 10.0, 0.0, TOO_MANY_EVENTS),
        (FAST, 1e3, 0.0, TOO_MANY_STEPS),
        (falling(0.5), 1.0, math.nan, NOT_FINITE),
    ],
)
def test_steps_that_fail_leave_the_state(p: Vector, duration: float, push: float, expected: int) -> None:
    x = OSCILLATOR.state.vector({"position": -1.0})
    before = x.copy()
    assert advance(x, p, 0.0, duration, push) == expected
    assert np.array_equal(x, before)


@pytest.mark.parametrize(("depth", "top"), [(1e-3, 0.02), (1e-6, 0.47), (1e-9, 0.5), (1e-9, 0.97)])
def test_grazing_inside_one_step_is_not_missed(depth: float, top: float) -> None:
    """A parabola's top above the wall by `depth`, both crossings inside one step of the integrator."""
    fall = -20.0
    speed = -fall * top
    p = falling(1.0, threshold=0.0)
    p[OSCILLATOR.parameters.index("weight")] = fall
    x = OSCILLATOR.state.vector({"position": depth - 0.5 * speed * top, "velocity": speed})
    assert advance(x, p, 0.0, 1.0) == OK
    assert x[2] == 1.0
    assert x[3] == pytest.approx(top - math.sqrt(2.0 * depth / -fall), abs=1e-10)
    below = OSCILLATOR.state.vector({"position": -1e-9 - 0.5 * speed * top, "velocity": speed})
    assert advance(below, p, 0.0, 1.0) == OK
    assert below[2] == 0.0


def test_cutting_a_step_changes_no_impact() -> None:
    p = OSCILLATOR.parameters.vector({"frequency": 2.0})
    horizon, rng = 20.0, np.random.default_rng(1)
    whole = OSCILLATOR.state.vector({"position": -1.0})
    assert advance(whole, p, 0.0, horizon) == OK
    for pieces in (2, 7, 60):
        cuts = np.concatenate([[0.0], np.sort(rng.uniform(0.0, horizon, pieces - 1)), [horizon]])
        x = OSCILLATOR.state.vector({"position": -1.0})
        for t, end in itertools.pairwise(cuts):
            assert advance(x, p, t, end - t) == OK
        assert x[2] == whole[2] > 5.0
        assert x == pytest.approx(whole, abs=1e-8)


def test_a_wall_passed_by_a_jump_of_its_state_acts_at_once() -> None:
    x = OSCILLATOR.state.vector({"position": 0.1, "velocity": 1.0})
    assert advance(x, falling(0.5), 3.0, 1e-3) == OK
    assert x[2] == 1.0
    assert x[3] == 3.0
