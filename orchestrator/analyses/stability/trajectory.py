"""The trajectory of a system, rates along it, and a participant advanced along it for linearisation."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterator, Mapping

import numpy as np

from models.core.quantities import Vector
from models.core.system import ModelError, System
from models.monolithic.trajectory import Trajectory, compute_trajectory

from ...engine.observer import Observer
from ...engine.step import Step
from ...errors import ParticipantError, RefusedError
from ...masters import MASTERS, Master
from ...participants.in_process import InProcessParticipant as in_process
from ...participants.protocol import BoundVariables, Participant
from ...run.simulation import simulate
from ...stepping import FixedSteps
from .linear import ROWS, Linear

# Tolerance of the iterated coupling: ten times that of the components' integration.
CONVERGED = 1e-9


def solve_course(
    system: System, times: Vector, tolerance: float, progress: Callable[[float], None]
) -> Trajectory:
    """Solve the system at equally spaced `times`, from its start values.

    If a component has no ODE form, the components are coupled in this process instead, by an iterated master
    with a macro step from each instant to the next. Raises ModelError or RunError.
    """
    if all(instance.component.ode for instance in system.instances.values()):
        return compute_trajectory(system, times, tolerance, progress)
    recorder = _CourseRecorder(system, times, progress)
    master = MASTERS["iterated"](extrapolation="hermite", tolerance=CONVERGED)
    steps = FixedSteps(float(times[1] - times[0]))
    simulate(system, recorder.units, master, steps, float(times[-1]), [recorder], float(times[0]))
    inputs = np.tile(system.u0, (len(times), 1))
    inputs[:, system.target_index] = recorder.outputs[:, system.source_index]
    return Trajectory(times, recorder.states, inputs, recorder.outputs, recorder.rates)


def run_course(
    system: System,
    units: Mapping[str, Participant],
    master: Master,
    times: Vector,
    progress: Callable[[float], None],
) -> Trajectory:
    """Couple `units` by `master` with a step from each of the equally spaced `times` to the next.

    Rates are differences of the outputs, and no states are known.
    """
    recorder = _OutputsRecorder(system, times, progress)
    interval = float(times[1] - times[0])
    try:
        simulate(system, units, master, FixedSteps(interval), float(times[-1]), [recorder], float(times[0]))
    except ParticipantError as error:
        if recorder.seen:
            raise
        raise RefusedError(error) from None
    inputs = np.tile(system.u0, (len(times), 1))
    inputs[:, system.target_index] = recorder.outputs[:, system.source_index]
    return Trajectory(times, {}, inputs, recorder.outputs, differentiate(recorder.outputs) / interval)


class _OutputsRecorder(Observer):
    """An observer that records outputs at each of `times`."""

    def __init__(self, system: System, times: Vector, progress: Callable[[float], None]) -> None:
        self._progress, self._times = progress, times
        self.outputs = np.zeros((len(times), system.outputs.size))
        self._row = 0

    @property
    def seen(self) -> bool:
        """Whether there were first values."""
        return self._row > 0

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        near = 1e-6 * (self._times[1] - self._times[0])
        if abs(time - self._times[self._row]) > near:
            return  # a step that ends at an event between two of them
        self.outputs[self._row] = outputs()
        self._row += 1
        self._progress(self._row / len(self.outputs))


class _CourseRecorder(_OutputsRecorder):
    """Records the states and rates of the components too."""

    def __init__(self, system: System, times: Vector, progress: Callable[[float], None]) -> None:
        super().__init__(system, times, progress)
        self.units = {name: in_process(name, instance) for name, instance in system.instances.items()}
        self._slots = system.outputs
        self.rates = np.zeros_like(self.outputs)
        # States of other components are never read, and there may be a thousand.
        self.states = {
            name: np.zeros((len(times), instance.component.state.size))
            for name, instance in system.instances.items()
            if instance.component.ode
        }

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        row = self._row
        for name, unit in self.units.items():
            state, rates = unit.state_and_rates()
            self.rates[row, self._slots.of(name)] = rates
            if name in self.states:
                self.states[name][row] = state
        super().observe(time, outputs, step)


# Twelve times the derivatives at the first two of five points.
ENDS = np.array([[-25.0, 48.0, -36.0, 16.0, -3.0], [-3.0, -10.0, 18.0, -6.0, 1.0]])


def differentiate(values: Vector) -> Vector:
    """Derivatives along the rows (at least five), a unit apart, by differences of fourth order."""
    found = np.empty_like(values)
    found[2:-2] = 8.0 * (values[3:-1] - values[1:-3]) - (values[4:] - values[:-4])
    found[:2] = ENDS @ values[:5]
    found[-2:] = -(ENDS @ values[:-6:-1])[::-1]
    return found / 12.0


def compute_rates(trajectory: Trajectory, system: System) -> Vector:
    """Time derivatives of all outputs, as `trajectory.outputs`.

    They are the participants' own rates: differences would smooth corners, such as that of a film whose
    entrainment reverses.
    """
    found = _derive_rates(trajectory, system) if trajectory.rates is None else trajectory.rates
    return np.asarray(np.nan_to_num(found))


def _derive_rates(trajectory: Trajectory, system: System) -> Vector:
    """Rates by the components' equations."""
    found = np.zeros_like(trajectory.outputs)
    driven = np.zeros_like(trajectory.inputs)
    # A cut algebraic loop starts with zero rates; a second pass corrects them.
    for name in system.order * (2 if system.torn else 1):
        driven[:, system.target_index] = found[:, system.source_index]
        instance, own = system.instances[name], system.outputs.of(name)
        c, inputs = instance.component, system.inputs.of(name)
        x, u, du = (
            np.ascontiguousarray(part)
            for part in (trajectory.states[name], trajectory.inputs[:, inputs], driven[:, inputs])
        )
        p, work = c.parameters.vector(instance.parameters), np.zeros(c.rates_work_size)
        rates = np.zeros((len(trajectory.times), c.outputs.size))
        give = c.flat_rates
        for k, t in enumerate(trajectory.times):
            give(t, x[k], u[k], du[k], p, work, rates[k])
        found[:, own] = np.nan_to_num(rates)
    return found


# Intervals of the trajectory in each step of a participant along it.
STRIDE = 2


class NotLinearError(ModelError):
    """A participant that cannot be linearised at an instant."""


def list_connected_inputs(name: str, system: System) -> list[str]:
    """Inputs that connections drive."""
    targets = {c.target.variable for c in system.connections if c.target.instance == name}
    return [n for n in system.instances[name].component.inputs.names if n in targets]


def list_continuous_outputs(name: str, system: System) -> list[str]:
    """Outputs that are not whole numbers."""
    outputs = system.instances[name].component.outputs
    return [f.name for f in outputs.fields if not f.quantity.discrete]


class ParticipantLinearisation(ABC):
    """Linearises a participant, which it advances with the inputs of a trajectory; the caller closes it."""

    _beyond = 0.0  # time (s) that it is stepped beyond an instant of the trajectory

    def __init__(self, name: str, participant: Participant, system: System) -> None:
        component = system.instances[name].component
        self.name, self._participant = name, participant
        self._layouts = component.inputs, component.outputs
        self.input_names = list_connected_inputs(name, system)
        self.output_names = list_continuous_outputs(name, system)
        self._columns = [component.inputs.index(n) for n in self.input_names]
        self._rows = [component.outputs.index(n) for n in self.output_names]
        self._slots = system.inputs.of(name)
        self._inputs = np.zeros((ROWS - 1, len(self.input_names)))
        self._outputs = np.zeros(len(self.output_names))
        bound = BoundVariables(self.input_names, self._inputs, self.output_names, self._outputs, np.zeros(0))
        participant.connect(bound)
        self._at: int | None = None
        self.held_inputs: list[str] = []

    @abstractmethod
    def about(self, trajectory: Trajectory, row: int, outputs: Collection[str]) -> Linear:
        """Linearise about an instant of the trajectory, with zero rows for outputs other than `outputs`.

        Call it with ascending rows.
        """

    def _advance_to(self, trajectory: Trajectory, row: int) -> None:
        """Advance along the trajectory to a row."""
        if self._at is None:
            self._values = trajectory.inputs[:, self._slots][:, self._columns]
            self._slopes = differentiate(self._values) / float(trajectory.times[1] - trajectory.times[0])
            self._participant.initialise(
                float(trajectory.times[0]), float(trajectory.times[-1]) + self._beyond
            )
            self._inputs[0], self._at = self._values[0], 0
            self._participant.write()
            self._participant.read()
            self._participant.finish_initialisation()
        while self._at < row:
            end = min(self._at + STRIDE, row)
            t, h = (
                float(trajectory.times[self._at]),
                float(trajectory.times[end] - trajectory.times[self._at]),
            )
            value, rate = self._values[[self._at, end]], self._slopes[[self._at, end]]
            mean = (value[1] - value[0]) / h
            self._inputs[:2] = value[0], rate[0]
            self._inputs[2] = 2.0 * (3.0 * mean - 2.0 * rate[0] - rate[1]) / h
            self._inputs[3] = 6.0 * (rate[0] + rate[1] - 2.0 * mean) / h**2
            self._participant.write()
            self._participant.advance(t, h)
            self._at = end

    def _expand(self, found: Linear, followed: Vector, kinks: list[str], outputs: Collection[str]) -> Linear:
        """Expand to all inputs and outputs of the component; `followed`: see `Linear`."""
        n, m, p = len(found.A), self._layouts[0].size, self._layouts[1].size
        B, C, D, coefficients = np.zeros((n, m)), np.zeros((p, n)), np.zeros((p, m)), np.ones((ROWS, m))
        B[:, self._columns] = found.B
        wanted = [(k, row) for k, row in enumerate(self._rows) if self.output_names[k] in outputs]
        for k, row in wanted:
            C[row] = found.C[k]
            D[row, self._columns] = found.D[k]
        coefficients[:, self._columns] = followed
        self.held_inputs = [
            name for name, rate in zip(self.input_names, followed[1], strict=True) if not rate
        ]
        return Linear(found.A, B, C, D, found.scale, tuple(kinks), coefficients)

    @property
    @abstractmethod
    def description(self) -> tuple[str, str]:
        """The method of linearisation, and the name with a remark."""

    def describe_doubts(self) -> Iterator[str]:
        """Sentences about what makes the result doubtful."""
        if self.held_inputs:
            yield (
                f"{self.name} holds its inputs {', '.join(self.held_inputs)} over a step (no _der1) and gets "
                "the mean of each signal: the error is of second order at best; limits and errors account "
                "for it."
            )
