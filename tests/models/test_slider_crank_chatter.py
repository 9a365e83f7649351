"""The end of the slider-crank's chatter is the limit point of its bounces."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.core.quantities import Vector
from models.slider_crank import forms
from models.slider_crank.flight.bouncing import CHATTER_LEFT
from models.slider_crank.records import mechanism
from models.slider_crank.walls import ends_chatter

from .slider_cranks import CRANK, INPUTS, STATE, TURN, thesis_parameters, turn

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
        pressing = forms.wall_acceleration(form, time, 1.0, 0.0, psi, m)
        pressing -= forms.flight_acceleration(form, time, 1.0, 0.0, psi, rate, m)
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
