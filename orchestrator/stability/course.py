"""Where a system goes, before its coupling is judged: solved as one problem, or else coupled tightly."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from models.core.quantities import Vector
from models.core.system import System
from models.monolithic.trajectory import Course, course

from ..engine.step import Step
from ..masters import MASTERS
from ..participants import in_process
from ..run.simulation import simulate
from ..stepping import FixedSteps

# To what a tight coupling converges: ten times what the components integrate to.
CONVERGED = 1e-9


def course_of(system: System, times: Vector, tolerance: float, progress: Callable[[float], None]) -> Course:
    """The system's course at equally spaced `times`, from its starts.

    A component that is no ODE cannot be solved with the others; all are then coupled in this process, with an
    iterated master and a macro step from each instant to the next. ModelError or RunError if that fails.
    """
    if all(instance.component.ode for instance in system.instances.values()):
        return course(system, times, tolerance, progress)
    taken = _Taken(system, times, progress)
    master = MASTERS["iterated"](extrapolation="hermite", tolerance=CONVERGED)
    steps = FixedSteps(float(times[1] - times[0]))
    simulate(system, taken.units, master, steps, float(times[-1]), [taken], float(times[0]))
    inputs = np.tile(system.u0, (len(times), 1))
    inputs[:, system.target_index] = taken.outputs[:, system.source_index]
    return Course(times, taken.states, inputs, taken.outputs, taken.rates)


class _Taken:
    """An observer that takes what a course has."""

    def __init__(self, system: System, times: Vector, progress: Callable[[float], None]) -> None:
        self.units = {name: in_process(name, instance) for name, instance in system.instances.items()}
        self._slots, self._progress = system.outputs, progress
        self.outputs = np.zeros((len(times), system.outputs.size))
        self.rates = np.zeros_like(self.outputs)
        # Of the others nobody asks for the states, of which there may be a thousand.
        self.states = {
            name: np.zeros((len(times), instance.component.state.size))
            for name, instance in system.instances.items()
            if instance.component.ode
        }
        self._row = 0

    def begin(self, names: object) -> None:
        pass

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        row, self._row = self._row, self._row + 1
        self.outputs[row] = outputs()
        for name, unit in self.units.items():
            state, rates = unit.state_and_rates()
            self.rates[row, self._slots.of(name)] = rates
            if name in self.states:
                self.states[name][row] = state
        self._progress((row + 1) / len(self.outputs))

    def end(self, complete: bool, message: str) -> None:
        pass
