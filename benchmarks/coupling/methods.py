"""Masters over the problem's macro steps, or with step control over tolerances."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from models.core.quantities import Vector
from orchestrator.engine.step import Step
from orchestrator.errors import RunError
from orchestrator.masters import MASTERS
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.participants.protocol import Participant
from orchestrator.run.plan import FmuFile
from orchestrator.run.simulation import Statistics, simulate
from orchestrator.stepping import StepControl, Stepper, control_steps

from .problem import CouplingProblem, Row, compute_errors

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)


@dataclass(frozen=True)
class Method:
    """A master by name, its signals, and for step control the estimator."""

    master: str
    extrapolation: str
    estimator: str = ""

    @property
    def name(self) -> str:
        return ", ".join(part for part in (self.master, self.extrapolation, self.estimator) if part)

    def settings(self, problem: CouplingProblem) -> tuple[float, ...]:
        """The macro steps (s), or the tolerances."""
        if self.estimator:
            return TOLERANCES
        return problem.held_ladder if self.extrapolation == "hold" else problem.ladder

    def steps(self, problem: CouplingProblem, setting: float) -> Stepper | float:
        """The step, or the step control with that relative tolerance, and absolute in nominal sizes."""
        if not self.estimator:
            return setting
        control = StepControl(self.estimator, relative=setting, absolute=setting)
        return control_steps(problem.ladder[-1], control)


@dataclass
class Trace:
    """An observer that records some outputs at the end of every step."""

    names: Sequence[str]
    times: list[float] = field(default_factory=list)
    rows: list[Vector] = field(default_factory=list)

    def begin(self, names: Sequence[str]) -> None:
        self._columns = [list(names).index(name) for name in self.names]

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if step.length > 0.0:
            self.times.append(time)
            self.rows.append(outputs()[self._columns])

    def end(self, complete: bool, message: str) -> None:
        pass


def measure_method(
    problem: CouplingProblem, files: Mapping[str, FmuFile], method: Method, setting: float
) -> Row:
    """A run of the method with a macro step (s), or a tolerance."""
    trace = Trace(problem.outputs)
    try:
        calls = _run(problem, files, method, setting, trace).do_steps
    except RunError as error:
        return Row(method.name, setting, note=str(error))
    errors = compute_errors(problem, np.array(trace.times), np.array(trace.rows))
    return Row(method.name, setting, calls, errors)


def _run(
    problem: CouplingProblem, files: Mapping[str, FmuFile], method: Method, setting: float, trace: Trace
) -> Statistics:
    master = MASTERS[method.master](extrapolation=method.extrapolation)
    participants: dict[str, Participant] = {}
    try:
        for name, instance in problem.system.instances.items():
            participants[name] = open_fmu(name, files[name].path, instance)
        steps = method.steps(problem, setting)
        return simulate(problem.system, participants, master, steps, problem.duration, [trace])
    finally:
        for participant in participants.values():
            participant.close()
