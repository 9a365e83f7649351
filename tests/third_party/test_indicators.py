"""Events whose indicator is met exactly at zero happen once: x' = 1 before, 1/2 after."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.core.quantities import Vector
from models.core.system import Instance, System
from models.monolithic.cvode import Cvode
from models.monolithic.march import march
from models.monolithic.runge_kutta import RungeKutta
from orchestrator.participants import read_component
from orchestrator.participants.model_exchange.integrated import DrivenEquations
from orchestrator.run.equations import PartwiseProblem

from .described import describe2, real2

Indicator = Callable[[float, float, float], float]


class Switching:
    """Stands for the equations of an FMU that is slow where its indicator z(t, x, u) is above zero, or with
    `falls` where it is not."""

    name, states, indicators = "switching", 1, 1

    def __init__(self, indicator: Indicator, falls: bool) -> None:
        self._indicator, self._falls = indicator, falls
        self._t, self._x, self._u = 0.0, np.zeros(1), np.zeros(1)
        self._above, self._sign, self.next_event = falls, 1.0, math.inf

    def initialise(self, start: float, stop: float) -> None:
        pass

    finish_initialisation = enter_events = close = lambda self: None

    def bind_inputs(self, names: Any) -> None:
        pass

    def outputs(self, t: float, x: Vector, u: Vector) -> Vector:
        self._t, self._x, self._u = t, x.copy(), u.copy()
        return self._x

    def rate(self) -> Vector:
        return np.array([1.0 if self._above == self._falls else 0.5])

    def guards(self) -> Vector:
        return self._sign * self._read()

    def iterate(self) -> bool:
        self._above = bool(self._read() > 0.0)
        return False

    def leave_events(self) -> float:
        self._sign = 1.0 if self._read() > 0.0 else -1.0
        return math.inf

    def get_states(self) -> Vector:
        return self._x

    def get_nominal(self) -> Vector:
        return np.ones(1)

    def _read(self) -> Vector:
        return np.array([self._indicator(self._t, self._x[0], self._u[0] if len(self._u) else 0.0)])


# z, whether it falls, and x at the end. Of these zeros each is met exactly.
MET: dict[str, tuple[Indicator, bool, float]] = {
    "rises": (lambda t, x, u: x - 0.55, False, 0.775),
    "falls": (lambda t, x, u: 0.55 - x, True, 0.775),
    "of time": (lambda t, x, u: t - 0.5, False, 0.75),
    "from the start on": (lambda t, x, u: x, False, 0.5),
    "flat": (lambda t, x, u: (x - 0.55) ** 3, False, 0.775),
}
OF_INPUT = {"of an input": (lambda t, x, u: u - 0.5, False, 0.75)}


@pytest.mark.parametrize(("indicator", "falls", "expected"), (MET | OF_INPUT).values(), ids=MET | OF_INPUT)
def test_an_fmu_that_is_integrated_here_has_the_event(
    indicator: Indicator, falls: bool, expected: float
) -> None:
    """Under the input u = t; x to what a flat zero can be located to, 1e-16^(1/3)."""
    problem = DrivenEquations(Switching(indicator, falls))  # type: ignore[arg-type]
    problem.connect(["u"])
    problem.inputs[1] = 1.0
    z = np.zeros(1)
    problem.iterate_events(0.0, z)
    found, events = march(problem, RungeKutta(problem, 1e-10, False, 0.1), z, 0.0, np.array([1.0]))
    assert found[0, 0] == pytest.approx(expected, abs=1e-5)
    assert len(events) == 1


@pytest.mark.parametrize("method", [Cvode, RungeKutta])
@pytest.mark.parametrize(("indicator", "falls", "expected"), MET.values(), ids=MET)
def test_the_reference_has_the_event(
    indicator: Indicator, falls: bool, expected: float, method: Any, tmp_path: Path
) -> None:
    component = read_component(describe2(tmp_path / "one.fmu", real2("x", 0, "output")))
    system = System({"one": Instance(component)}, [])
    problem = PartwiseProblem(system, {"one": Switching(indicator, falls)}, {})  # type: ignore[dict-item]
    z = problem.start(0.0, 1.0)
    found, _ = march(problem, method(problem, 1e-10, False, 0.1), z, 0.0, np.array([1.0]))
    assert found[0, 0] == pytest.approx(expected, abs=1e-5)
