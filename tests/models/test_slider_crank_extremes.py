"""Motions at the ends of the parameters' ranges, and the end of chatter as the limit point of its bounces."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from models.core.quantities import Vector
from models.slider_crank import forms
from models.slider_crank.equations import Crank, inertia
from models.slider_crank.flight.bouncing import CHATTER_LEFT
from models.slider_crank.flight.flow import UnresolvedError
from models.slider_crank.motions.histories import ONSET
from models.slider_crank.motions.machine import FASTEST, FORMS, Machine, Motion, exponents_of
from models.slider_crank.nonlinear import free_moment, offset
from models.slider_crank.records import mechanism
from models.slider_crank.walls import ends_chatter

from .slider_cranks import CRANK, INPUTS, STATE, TURN, thesis_parameters, turn


def test_impact_at_the_end_of_a_cell_is_followed_by_the_rest_of_the_revolution() -> None:
    """Without forces the slider crosses at constant speed: an eighth of a turn to the wall, then, at half the
    speed, half a turn to the other one. An eighth of a turn is eight cells."""
    machine = Machine(damping=0.0, gap=0.0625, restitution=0.5, xi=0.0)
    found = Motion(machine, psi_rate=0.0625 / (TURN / 8.0)).events(2)
    at = TURN * found.cycle + found.theta
    np.testing.assert_allclose(at, [TURN / 8.0, TURN * 5.0 / 8.0, TURN * 13.0 / 8.0], rtol=1e-14)
    np.testing.assert_array_equal(found.side, [1.0, -1.0, 1.0])


@pytest.mark.parametrize("rate", [5.0, 1e5])
def test_fast_rod_reaches_the_wall_when_its_free_flight_does(rate: float) -> None:
    """Nonlinear form, wide gap: the rod swings by a third of a radian within a small part of a cell."""
    machine = Machine(form="nonlinear", gap=0.3, restitution=1.0)
    m = machine.mechanism

    def flight(theta: float, state: np.ndarray) -> list[float]:
        return [state[1], free_moment(Crank(theta, 1.0, 0.0), state[0], state[1], m) / inertia(m)]

    def reach(theta: float, state: np.ndarray) -> float:
        return offset(theta, state[0], m.xi) - machine.gap

    reach.terminal = True  # type: ignore[attr-defined]
    path = solve_ivp(flight, (0.0, 1.0), [0.0, rate], "DOP853", events=reach, rtol=1e-12, atol=1e-14)
    first = Motion(machine, psi_rate=rate).events(1).where(0)
    assert first.theta == pytest.approx(path.t_events[0][0], rel=1e-11)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("damping", [8.0, 30.0, 200.0])
def test_strong_damping_is_resolved(form: str, damping: float) -> None:
    """A push without a wall in reach: the rate falls as exp(-lambda theta / a) towards that of the joint."""
    machine = Machine(damping=damping, gap=0.05, xi=0.0, form=form)
    rate, scale = -0.01 * damping, damping / inertia(machine.mechanism)
    _, states = Motion(machine, psi_rate=rate).trace(1, 800)
    theta = TURN / 800.0 * np.arange(5)
    expected = theta + (rate - 1.0) * -np.expm1(-scale * theta) / scale
    np.testing.assert_allclose(states[:5, 0], expected, atol=1e-12)


@pytest.mark.parametrize(("xi", "damping"), [(0.01, 0.0), (0.01, 1e-6), (0.1, 30.0), (1e-4, 0.0)])
def test_small_coefficients_are_not_taken_for_unresolved_ones(xi: float, damping: float) -> None:
    """Their rounding is that of the larger ones, and stays what it is with any number of cells."""
    for form in FORMS:
        assert Machine(xi=xi, damping=damping, form=form).flow.pressing.shape[0] <= 512


@pytest.mark.parametrize("damping", [1e4, pytest.param(1e300, marks=pytest.mark.long)])
def test_damping_that_no_cell_resolves_is_refused(damping: float) -> None:
    with pytest.raises(UnresolvedError, match=r"damping = .*less damping"):
        Motion(Machine(damping=damping)).skip(1)


@pytest.mark.parametrize(
    ("psi", "rate", "name"), [*((0.0, v, "psi_rate") for v in (math.nan, -2.0 * FASTEST)), (0.02, 0.0, "psi")]
)
def test_start_out_of_range_is_refused(psi: float, rate: float, name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name} = "):
        Motion(Machine(gap=0.01), psi, rate)


def test_elastic_bounces_below_rounding_are_sliding() -> None:
    """e = 1: bounces that never get lower would have no end, and friction would make them ever shorter."""
    first = Motion(Machine(restitution=1.0), psi=0.01, psi_rate=1e-18).events(1).where(0)
    assert first.kind == ONSET
    pressed = Motion(Machine(damping=5.0, gap=0.001, restitution=1.0, alpha=0.0, beta=0.0))
    assert pressed.skip(10).strobe(1)[0, 2] == 1.0


def test_plastic_impacts_leave_the_largest_exponent() -> None:
    """e = 0 ends one direction, not both."""
    growths = np.column_stack([np.full(4, 0.5), np.full(4, -math.inf)])
    found = exponents_of(Machine(restitution=0.0), growths, 8, 1)
    assert found.largest == pytest.approx(0.5 / TURN)
    assert found.second == found.exact_sum == -math.inf


GAP = 0.015
IMPULSE, FORCE_INTEGRAL = STATE.index("upper_impact_impulse"), STATE.index("upper_force_integral")
LOSS = STATE.index("impact_loss")


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    pressing=st.floats(1e-3, 1e4),
    restitution=st.floats(0.0, 0.99),
    speed=st.floats(-500.0, 500.0),
    acceleration=st.floats(-1e5, 1e5),
)
def test_bounces_end_when_what_remains_turns_the_crank_by_chatter_left(
    pressing: float, restitution: float, speed: float, acceleration: float
) -> None:
    """T = 2 v / ((1 - e) a) and |theta'| T + |theta''| T^2/2 = CHATTER_LEFT, to 1 %."""
    p = CRANK.parameters.view(CRANK.parameters.vector({"restitution": restitution}))
    u = INPUTS.view(INPUTS.vector({"crank_speed": speed, "crank_acceleration": acceleration}))
    if abs(speed) + abs(acceleration) < 1e-3:
        return
    root = math.sqrt(speed**2 + 2.0 * abs(acceleration) * CHATTER_LEFT)
    parting = 0.5 * (1.0 - restitution) * pressing * 2.0 * CHATTER_LEFT / (abs(speed) + root)
    assert ends_chatter(0.99 * parting, pressing, 0.0, u, p)
    assert not ends_chatter(1.01 * parting, pressing, 0.0, u, p)
    assert not ends_chatter(0.0, -pressing, 0.0, u, p)


def test_elastic_bounces_do_not_end() -> None:
    p = CRANK.parameters.view(CRANK.parameters.vector({"restitution": 1.0}))
    u = INPUTS.view(INPUTS.vector({"crank_speed": 100.0}))
    assert not ends_chatter(1e-12, 10.0, 0.0, u, p)


def follow_chatter(p: Vector, restitution: float) -> tuple[Vector, Vector]:
    """Times of the impacts from rest to the first sliding, and T = 2 v / ((1 - e) a) after each one."""
    form, m = p[0], mechanism(CRANK.parameters.view(p))
    x, times, left = STATE.vector(), [], []
    for k in itertools.count():
        count = x[3] + x[4]
        turn(CRANK, x, p, 0.001 * k, 0.001)
        if x[3] + x[4] == count:
            continue
        # Of several impacts in a piece the last one is seen, which is enough.
        time, approach = x[10], x[11]
        psi = forms.wall_angle(form, time, GAP, m)
        rate = forms.wall_rate(form, time, 1.0, psi, m)
        pressing = forms.wall_acceleration(form, Crank(time, 1.0, 0.0), psi, m)
        pressing -= forms.flight_acceleration(form, Crank(time, 1.0, 0.0), psi, rate, m)
        parting = restitution * approach / forms.offset_slope(form, time, psi, m)
        times.append(time)
        left.append(2.0 * parting / ((1.0 - restitution) * abs(pressing)))
        if x[2] != 0.0:
            return np.array(times), np.array(left)
    raise AssertionError


@pytest.mark.parametrize("form", [forms.CORRECTED, forms.NONLINEAR])
@pytest.mark.parametrize("restitution", [0.3, 0.5])
def test_sliding_begins_at_the_limit_of_the_impact_times(form: float, restitution: float) -> None:
    """From every late impact T = 2 v / ((1 - e) a) leads there, to O(T^2): a changes by O(T) meanwhile.

    The onset itself is known to what its own T leaves, which rounding sets here (some 1e-7 rad).
    """
    p = thesis_parameters(0.3, GAP, restitution=restitution, form=form)
    times, left = follow_chatter(p, restitution)
    late = (left < 0.1) & (left > 2e-3)
    misses = np.abs(times + left - times[-1])[late]
    assert late.sum() >= 3
    assert left[-1] < 2e-7
    assert (misses < 0.25 * left[late] ** 2 + left[-1]).all()


@pytest.mark.parametrize("form", [forms.AS_PUBLISHED, forms.NONLINEAR])
@pytest.mark.parametrize("restitution", [0.5, 0.9])
def test_threshold_of_the_thesis_converges_to_the_limit(form: float, restitution: float) -> None:
    """F's threshold epsilon changes impulse and loss of a revolution by less than epsilon^2, the motion after
    the release not at all (to the integrator's rounding; release is from the wall)."""

    def run_three_turns(threshold: float) -> Vector:
        p = thesis_parameters(0.25, GAP, restitution=restitution, form=form, sliding_threshold=threshold)
        x = STATE.vector()
        for k in range(3):
            turn(CRANK, x, p, k * TURN, TURN)
        return x

    limit = run_three_turns(0.0)
    for threshold in (1e-3, 1e-4, 1e-5):
        found = run_three_turns(threshold)
        impulse = found[IMPULSE] + found[FORCE_INTEGRAL] - limit[IMPULSE] - limit[FORCE_INTEGRAL]
        assert abs(impulse) < threshold**2
        assert abs(found[LOSS] - limit[LOSS]) < threshold**2
        assert np.abs(found[:2] - limit[:2]).max() < 1e-12
