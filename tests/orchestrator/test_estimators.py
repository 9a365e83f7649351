"""Estimators against the true local error: one step from a point of the exact motion, with an exact past.

The quarter car exchanges states (no feedthrough); of the two masses one gives a force that depends on its
inputs at the same instant. Steps are short enough for the leading term of the error to rule, and the
reference is solved to 1e-13, far below the local errors compared (1e-9 and more).
"""

import functools

import numpy as np
import pytest

from models.monolithic import solve
from orchestrator.engine.coupling import Coupling
from orchestrator.engine.sweeps import propagate
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.stepping import check_estimator
from orchestrator.stepping.estimators import ESTIMATORS

from .coupled import build_participants
from .two_masses import two_masses

PAST = 3


def systems():
    return {"quarter car": build_system(load("quarter-car")), "two masses": two_masses()}


def at_point(system, master, start, length):
    """An coupling whose participants, values and history are those of the exact motion, and what follows."""
    times = np.concatenate([[0.0], start + length * np.arange(1 - PAST, 2)])
    reference = solve(system, times, tolerance=1e-13)
    units = build_participants(system)
    coupling = Coupling(system, units, master.degree)
    coupling.initialise(0.0, 1.0)
    for k in range(1, PAST + 1):
        for name, unit in units.items():
            unit._x[:] = reference.state[k][system.state.of(name)]
            unit._t = times[k]
        columns = [system.outputs.index(port) for port in coupling.wiring.sources]
        coupling.state.values[:] = reference.outputs[k][columns]
        for _ in range(3):  # values pass at once, rates one participant further each time
            propagate(coupling, coupling.wiring.all, times[k])
        if k == 1:
            coupling.state.history.restart()
        coupling.accept(times[k])
    coupling.state.history.count = PAST
    return coupling, times[PAST], reference.outputs[PAST + 1][columns]


TIGHT = 1e-13
LENGTHS = {"hold": 1e-4, "linear": 1e-3, "quadratic": 2e-3, "hermite": 5e-3}
METHODS = (
    ("step_doubling", Jacobi),
    ("step_doubling", GaussSeidel),
    ("step_doubling", functools.partial(Iterated, tolerance=TIGHT)),
    ("predictor_corrector", functools.partial(Iterated, tolerance=TIGHT)),
)
CASES = [
    pytest.param(estimator, kind(signal), marks=[pytest.mark.long] * (signal in ("hold", "quadratic")))
    for estimator, kind in METHODS
    for signal in LENGTHS
]


@pytest.mark.parametrize("name", ["quarter car", "two masses"])
@pytest.mark.parametrize(("estimator", "master"), CASES, ids=str)
def test_estimated_over_true_local_error_in_the_asymptotic_range(name, estimator, master, record):
    system = systems()[name]
    length = LENGTHS[master.extrapolation] * (1.0 if name == "quarter car" else 4.0)
    coupling, time, truth = at_point(system, master, 0.3, length)
    with coupling.points.keep():
        attempt = ESTIMATORS[estimator](coupling, master, time, length)
    true = (coupling.state.values - truth) / coupling.wiring.nominal
    # Along the true error, so that its sign counts.
    ratio = attempt.error / coupling.wiring.nominal @ true / (true @ true)
    assert np.abs(true).max() > 1e-10  # above the reference's rounding
    # From a half to twice.
    quantity = f"log2 of estimated over true local error, {name}, {estimator}"
    record("Coupling", quantity, np.log2(ratio), 0.0, "monolithic solution", tolerance=1.0)


@pytest.mark.parametrize(
    ("estimator", "master", "remedy"),
    [
        ("predictor_corrector", Jacobi(), "use iterated"),
        ("defect", Iterated(), "use predictor_corrector"),
    ],
)
def test_an_estimator_refuses_masters_that_it_cannot_judge(estimator, master, remedy):
    with pytest.raises(ValueError, match=f"estimator = '{estimator}'.*{remedy}"):
        check_estimator(estimator, master)
