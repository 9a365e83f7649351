"""The embedded pair of Bogacki and Shampine: order, error estimate, a rate that refuses."""

from itertools import takewhile

import numpy as np
import pytest

from models.core.embedded_pair import march, try_step
from models.core.errors import ModelError


def decay(y):
    """y' = -y^2: y = 1/(1 + x) from 1."""
    return -(y**2)


def test_a_step_has_order_3_and_its_estimate_order_2():
    """Halved, a step has a 2^4th of its error and a 2^3th of its estimate."""
    errors, estimates, between = [], [], []
    for length in (0.2, 0.1, 0.05, 0.025):
        step = try_step(decay, 0.0, length, np.ones(1), decay(np.ones(1)))
        errors.append(abs(step.states[1][0] - 1.0 / (1.0 + length)))
        estimates.append(step.error)
        between.append(abs(step.at(0.5)[0] - 1.0 / (1.0 + 0.5 * length)))
    for found, order in ((errors, 4.0), (estimates, 3.0), (between, 4.0)):
        orders = np.log2(np.array(found[:-1]) / found[1:])
        assert orders[-1] == pytest.approx(order, abs=0.15)


def test_the_error_falls_with_the_number_of_evaluations_by_order_2():
    """Of the error per change, so that a tolerance of 1/16 takes about 4 times as many; the estimate bounds
    the true error."""
    counts, errors = [], []
    for tolerance in (1e-2, 1e-2 / 16.0, 1e-2 / 256.0):
        count = 0

        def rate(y):
            nonlocal count
            count += 1
            return decay(y)

        steps = list(
            takewhile(
                lambda step: step.begin < 9.0,
                march(rate, np.ones(1), rate(np.ones(1)), 0.1, tolerance, lambda y, f: (0.0, 10.0)),
            )
        )
        true = max(abs(s.states[1][0] - 1.0 / (1.0 + s.begin + s.length)) for s in steps)
        estimated = sum(s.error for s in steps)
        change = 1.0 - steps[-1].states[1][0]
        assert true <= estimated <= tolerance * change
        counts.append(count)
        errors.append(true)
    assert counts[2] < 5.0 * counts[1] < 25.0 * counts[0]
    # Of the solution, which has one order more: about 16^(3/2) each.
    assert errors[2] < errors[1] / 16.0 < errors[0] / 256.0


def test_a_refused_step_is_shortened_and_a_hopeless_one_raised():
    def rate(y):
        if y[0] < 0.5:
            raise ModelError("too little")
        return -np.ones(1)

    reached = list[float]()
    steps = march(rate, np.ones(1), -np.ones(1), 0.4, 1e-2, lambda y, f: (0.3, 1.0))
    with pytest.raises(ModelError, match="too little"):
        reached.extend(step.states[1][0] for step in steps)
    assert reached[0] == pytest.approx(0.6, abs=1e-15)
    assert reached[-1] == pytest.approx(0.5, abs=1e-4)


def test_the_shortest_step_is_taken_whatever_its_error():
    """For this tolerance the first steps would be shorter than 0.01."""
    steps = march(decay, np.ones(1), decay(np.ones(1)), 0.5, 1e-9, lambda y, f: (0.5, 0.5))
    found = [next(steps) for _ in range(3)]
    assert [step.begin for step in found] == [0.0, 0.5, 1.0]
    assert found[0].error > 1e-9
