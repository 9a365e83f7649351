"""DOP853 with compiled stages is scipy's DOP853, and right between the ends of its steps too."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import DOP853
from scipy.optimize import brentq

from models.monolithic.dop853 import LARGEST_DEFECT, CompiledDop853, JudgedDop853
from models.monolithic.problem import SystemProblem

from .systems import valve_train

# So wide that every step is accepted: rejected ones are made shorter by estimates near rounding.
OPTIONS = {"rtol": 1e-3, "atol": 1e-3, "max_step": 2e-4}
END = 1e-3


@pytest.mark.parametrize(
    "motion", [pytest.param("prescribed", marks=pytest.mark.long), "free: an algebraic loop"]
)
def test_every_step_is_scipys(motion: str) -> None:
    """From the same state with the same length: 1e-13 is the rounding of sums in another order."""
    free = {"motion": 0.0, "inertia": 0.02}
    problem = SystemProblem(valve_train(1000.0, flywheel=free if motion.startswith("free") else None))
    z = problem.start(problem.system.x0)
    t, steps = 0.0, 0

    def rate(t: float, z: Any) -> Any:
        return problem.rate(t, np.ascontiguousarray(z)).copy()

    while t < END:
        begun = (t, z, END)
        theirs = DOP853(rate, *begun, first_step=min(1e-5, END - t), **OPTIONS)
        ours = CompiledDop853(problem, rate, *begun, first_step=min(1e-5, END - t), **OPTIONS)
        theirs.step()
        ours.step()
        middle = 0.5 * (t + theirs.t)
        size = problem.nominal + np.abs(theirs.y)
        assert ours.t == theirs.t
        assert np.max(np.abs(ours.y - theirs.y) / size) < 1e-13
        assert np.max(np.abs(ours.dense_output()(middle) - theirs.dense_output()(middle)) / size) < 1e-13
        t, z, steps = theirs.t, theirs.y, steps + 1
    assert steps >= 100


def test_a_rate_that_is_not_finite_ends_in_a_failure() -> None:
    """The step shrinks to nothing; it does not grow."""
    system = valve_train(1000.0)
    problem = SystemProblem(system)
    z0 = problem.start(system.x0)
    start = problem.rate(0.0, z0).copy()
    solver = CompiledDop853(problem, lambda t, z: start, 0.0, z0, END, **OPTIONS)
    system.p[system.parameters.names.index("valve_spring.valve_mass")] = np.nan
    assert solver.step() is not None
    assert solver.status == "failed"


def largest_error(solver: Any) -> float:
    """Of a solution of y' = -y, y(0) = 1, at and between the ends of steps up to the solver's end."""
    largest = 0.0
    while solver.status == "running":
        solver.step()
        instants = np.linspace(solver.t_old, solver.t, 101)
        largest = max(largest, float(np.max(np.abs(solver.dense_output()(instants) - np.exp(-instants)))))
    return largest


@pytest.mark.parametrize("tolerance", [1e-5, 1e-7, 1e-9])
def test_a_step_for_which_the_error_estimate_vanishes_is_not_kept(tolerance: float) -> None:
    """The estimate of order 5 of a step of y' = -y is a polynomial of its length, with a zero near 5.7."""

    def solver(method: Any, length: float, rtol: float = tolerance) -> Any:
        return method(lambda t, y: -y, 0.0, np.ones(1), 10.0, rtol=rtol, atol=rtol, first_step=length)

    def estimate(length: float) -> float:
        accepting = solver(DOP853, length, rtol=1e6)
        accepting.step()
        return float(accepting.K[:, 0] @ accepting.E5)

    blind = brentq(estimate, 5.5, 6.0, xtol=1e-15)
    assert largest_error(solver(DOP853, blind)) > 1e-3
    # An eighth of the defect in each step; a decaying solution forgets the errors of earlier steps.
    assert largest_error(solver(JudgedDop853, blind)) < 0.2 * LARGEST_DEFECT * tolerance
