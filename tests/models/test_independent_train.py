"""The valve train against an integration that shares nothing with it, which notices wrong physics."""

import math

import numpy as np
import pytest

from models.monolithic.problem import SystemProblem

from .independent_train import OUTPUTS, STATES, Train, runge_kutta
from .systems import column, run, valve_train

# The contact's mode, 6.7 kHz, turns by 0.08 rad in a step: an error of 1e-7 of what the jumps of jerk excite.
STEP = 2e-6
# Of an output's largest value. Loads follow positions, good to 1e-12 m, by 4e8 N/m; up to 3e-6 is seen.
TOLERANCE = 1e-5


def start_of(system, states):
    values = dict(zip(STATES, states, strict=True))
    return np.array(
        [values.get(name, given) for name, given in zip(system.state.names, system.x0, strict=True)]
    )


@pytest.mark.parametrize(
    ("speed_rpm", "flexible"), [pytest.param(1000, False, marks=pytest.mark.long), (2000, True)]
)
def test_the_valve_train_moves_as_in_an_independent_integration(speed_rpm, flexible):
    """Over a whole event: cam, shaft, coils, Hertz's contact and film together."""
    train = Train(speed_rpm * math.pi / 30.0, flexible)
    every = 50
    steps = round(0.8 * 60.0 / speed_rpm / STEP / every) * every
    states = runge_kutta(train.rates, train.start(), 0.0, STEP, steps)
    times = STEP * np.arange(0, steps + 1, every)
    expected = np.array([train.observe(t, x) for t, x in zip(times, states[::every], strict=True)])
    system = valve_train(speed_rpm, camshaft={"flexible": float(flexible)})
    found = run(SystemProblem(system), start_of(system, states[0]), times)
    for name, wanted in zip(OUTPUTS, expected.T, strict=True):
        error = np.abs(column(system, found, name) - wanted).max() / np.abs(wanted).max()
        assert error < TOLERANCE, name
