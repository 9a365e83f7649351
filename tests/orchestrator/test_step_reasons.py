"""What set a step's length: the error only where it did."""

import math

import numpy as np
import pytest

from orchestrator.engine.step import REASONS
from orchestrator.stepping import ControlledSteps, StepControl

from .faulty_runs import CONTROLLED, TOLERANCE, faulty, simulated
from .test_events import bouncing, controlled, hermite

ERROR, GROWTH = REASONS.index("error"), REASONS.index("growth")


def steps_of(kind, first):
    """Those of two masses from a first step of this length (s)."""
    master, estimator = CONTROLLED[kind]
    control = StepControl(estimator, relative=TOLERANCE, absolute=TOLERANCE)
    recorder, ended = simulated(faulty(), master, ControlledSteps(first, control))
    assert ended is None
    return recorder.steps[1:]  # the start is a step of no length


@pytest.mark.parametrize("kind", CONTROLLED)
def test_a_first_step_far_too_short_grows_until_the_error_sets_the_length(kind):
    """Doubling at most takes the binary logarithm of the ratio; begun at that length, little has to grow."""
    first = 1e-9
    steps = steps_of(kind, first)
    length = float(np.median([step.length for step in steps if step.reason == ERROR]))
    growing = next(i for i, step in enumerate(steps) if step.reason == ERROR)
    assert {step.reason for step in steps[:growing]} == {GROWTH}
    assert growing >= math.log2(steps[growing].length / first)
    begun_there = sum(step.reason == GROWTH for step in steps_of(kind, length))
    assert begun_there < 0.2 * growing


def test_free_flight_is_never_limited_by_the_error():
    """Between bounces nothing is exchanged that changes the motion: the coupling has no error there."""
    recorder, truth, _ = bouncing(controlled(1e-7), hermite(1e-7), 1.0)
    flying = truth[:, 0] > 1e-3  # m over the stop
    ends, steps = np.flatnonzero(flying), recorder.steps
    inside = [steps[i] for i in ends[1:] if flying[i - 1]]
    assert len(inside) > 10
    assert ERROR not in {step.reason for step in inside}
    assert {step.reason for step in steps[1:]} >= {ERROR, GROWTH}
