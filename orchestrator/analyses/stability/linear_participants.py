"""Linear participants coupled by a master, in many copies, with evolving data that can be set and read.

A coupled run of linear participants is a linear map from one macro step to the next. `macro_step` reads its
matrix off the master itself, with one copy for each column.
The error of a signal's extrapolation over a step is amounts of a few polynomial shapes.
"""

import math
from collections.abc import Mapping, Sequence
from functools import cache
from types import SimpleNamespace
from typing import Any, NoReturn, cast

import numpy as np
from numpy.polynomial import Polynomial

from models.core.component import Component
from models.core.quantities import Vector
from models.core.system import Connection, Instance, Port, System

from ...engine.coupling import Coupling
from ...engine.signals import DEGREES, NEEDED, POINTS
from ...errors import CannotSerializeError
from ...masters import Master
from ...participants.capabilities import HIGHEST, find_highest_degrees
from ...participants.compiled_calls import IN_PROCESS, NotCompiledError
from ...participants.protocol import Abilities, BoundVariables
from .linear import ROWS, Linear

HERMITE = DEGREES["hermite"]


def compute_extrapolation_error(
    values: Vector, rates: Vector, step: float, degree: int, middles: Vector | None = None
) -> Vector:
    """Values minus their extrapolation: amounts of the `shapes`, (instants x shapes x sources).

    `values` and `rates` (instants x sources) are a macro step apart; row n of the result is for the step that
    ends at instant n, and zero without a full past. `middles` are values halfway, row n for the step that
    ends at instant n + 1.
    """
    amounts = np.zeros((len(values), len(build_shapes(step, degree)), values.shape[1]))
    if degree != HERMITE:
        amounts[degree + 1 :, 0] = np.diff(values, degree + 1, axis=0)
        return amounts
    # The cubic through the last two values and rates, one step on; rates are those times the step.
    slopes = step * rates
    first, start, end = values[:-2], values[1:-1], values[2:]
    guess = 5.0 * first - 4.0 * start + 2.0 * slopes[:-2] + 4.0 * slopes[1:-1]
    guessed_slope = 12.0 * (first - start) + 5.0 * slopes[:-2] + 8.0 * slopes[1:-1]
    amounts[2:, 0] = end - guess
    amounts[2:, 1] = slopes[2:] - guessed_slope
    if middles is None:
        # Exact for a polynomial of fourth order.
        amounts[2:, 2] = amounts[2:, 0] / 64.0
    else:
        amounts[2:, 2] = middles[1 : len(values) - 1] - (
            0.5 * (start + end) + 0.125 * (slopes[1:-1] - slopes[2:])
        )
    return amounts


@cache
def build_shapes(step: float, degree: int) -> Vector:
    """Taylor coefficients (shapes x ROWS), at the start of a step, of the error of a signal of `degree`.

    The shape vanishes at the signal's known values and is one at the end of the step. Hermite signals have
    three shapes, because rates may jump: value one at the end, rate one (per step) at the end, and one in the
    middle with neither.
    """
    s = Polynomial([0.0, 1.0 / step])
    if degree == HERMITE:
        polynomials = [3.0 * s**2 - 2.0 * s**3, s**3 - s**2, 16.0 * s**2 * (1.0 - s) ** 2]
    else:
        polynomials = [Polynomial([1.0])]
        for k in range(degree + 1):
            polynomials[0] = polynomials[0] * (s + float(k)) / (k + 1.0)
    coefficients = np.zeros((len(polynomials), ROWS))
    for row, shape in zip(coefficients, polynomials, strict=True):
        row[: len(shape.coef)] = shape.coef
    coefficients *= [math.factorial(k) for k in range(ROWS)]
    coefficients.flags.writeable = False
    return coefficients


def evaluate_ends(step: float, degree: int) -> Vector:
    """Values and rates (2 x shapes) of the shapes at the end of the step."""
    powers = np.array([step**k / math.factorial(k) for k in range(ROWS)])
    coefficients = build_shapes(step, degree)
    return np.array([coefficients @ powers, coefficients[:, 1:] @ powers[:-1]])


def name_copies(name: str, count: int) -> list[str]:
    """A variable's names in `count` copies; unchanged for one copy."""
    return [name] if count == 1 else [f"{name}#{k}" for k in range(count)]


class BatchedSystem:
    """`count` copies of a system as a coupling sees it: outputs load#0, load#1, ..."""

    def __init__(self, system: System, count: int) -> None:
        self.instances: dict[str, Any] = {}
        self.nominal: list[float] = []
        self.order, self.torn = system.order, system.torn
        self.outputs = self
        self._numbers: dict[Port, int] = {}
        for name, instance in system.instances.items():
            layout = instance.component.outputs
            fields = {copy: layout.field(own) for own in layout.names for copy in name_copies(own, count)}
            names = list(fields)
            # The matrices hold the direct feedthrough.
            outputs = SimpleNamespace(names=names, field=fields.__getitem__)
            component = SimpleNamespace(outputs=outputs, feedthrough={})
            self.instances[name] = SimpleNamespace(component=component)
            for variable, nominal in zip(names, np.repeat(layout.nominal, count), strict=True):
                self._numbers[Port(name, variable)] = len(self.nominal)
                self.nominal.append(float(nominal))
        self.connections = tuple(
            Connection(Port(c.source.instance, out), Port(c.target.instance, into))
            for c in system.connections
            for out, into in zip(
                name_copies(c.source.variable, count), name_copies(c.target.variable, count), strict=True
            )
        )

    def index(self, port: Port) -> int:
        """The index of an output among all outputs."""
        return self._numbers[port]


class LinearParticipant:
    """Implements `Participant` for `count` copies of a linearised instance.

    Inputs and outputs are trajectory plus deviation; the states `x` (states x copies) are deviations. The
    trajectory is at rest unless `LinearCoupling.add_extrapolation_error` changes it for the next step.
    """

    abilities = Abilities(unserialisable="a linear participant ends with its analysis")

    def __init__(self, name: str, instance: Instance, linear: Linear, count: int = 1) -> None:
        self.name, self.count = name, count
        self._component = instance.component
        inputs, outputs = linear.B.shape[1], linear.C.shape[0]
        self._U = np.zeros((ROWS, inputs, count))
        self.trajectory = np.zeros((ROWS, inputs, count))
        self.straight = np.zeros((inputs, count))  # change of the trajectory's inputs over the step
        self.course_end = np.zeros((2, outputs, count))
        # Deviation of the inputs and its rate; outputs and rates of the trajectory.
        self._u = np.zeros((2, inputs, count))
        self._y = np.zeros((2, outputs, count))
        self.set_matrices(linear)

    def set_matrices(self, linear: Linear) -> None:
        """Take these matrices, with all deviations zero."""
        self._linear = linear
        self.x = np.zeros((linear.A.shape[0], self.count))
        self.reset()

    def reset(self) -> None:
        """Set all deviations to zero."""
        for memory in (self.x, self._U, self._u, self._y, self.trajectory, self.straight, self.course_end):
            memory[:] = 0.0

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        return [ROWS - 2] * len(input_names)

    def compiled_calls(self) -> NoReturn:
        raise NotCompiledError(IN_PROCESS)

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        c = self._component
        self._into = _find_columns(c.inputs.names, bound.input_names, self.count)
        self._out = _find_columns(c.outputs.names, bound.output_names, self.count)
        self._inputs, self._outputs, self._rates = bound.inputs, bound.outputs, bound.rates
        return [True] * len(bound.output_names)

    def initialise(self, start_time: float, stop_time: float) -> None:
        pass

    def finish_initialisation(self) -> None:
        pass

    def set_inputs(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            self._U[0, self._component.inputs.index(name)] = value
        self._u[:] = self._U[:2] - self.trajectory[:2]

    def write(self) -> None:
        given = self._U.reshape(ROWS, -1)
        given[: len(self._inputs), self._into] = self._inputs
        if self._linear.followed is not None:
            self._U *= np.where(self._linear.held, 1.0, self._linear.followed)[:, :, None]
        self._u[:] = self._U[:2] - self.trajectory[:2]

    def advance(self, time: float, step: float) -> None:
        phi, gamma, ends = self._linear.step(step)
        deviation = self._U - self.trajectory
        self._u[:] = (ends @ deviation.reshape(-1, self.count)).reshape(self._u.shape)
        if (held := self._linear.held).any():
            means = [step**k / math.factorial(k + 1) for k in range(ROWS)]
            deviation[:, held] = -self.trajectory[:, held]
            deviation[0, held] += np.tensordot(means, self._U[:, held], 1) + 0.5 * self.straight[held]
            deviation[1, held] -= self.straight[held] / step
        self.x[:] = phi @ self.x + gamma @ deviation.reshape(-1, self.count)
        self._y[:] = self.course_end

    def read(self) -> None:
        m = self._linear
        y = self._y[0] + m.C @ self.x + m.D @ self._u[0]
        np.take(y.ravel(), self._out, out=self._outputs)
        if self._rates.size:
            rate = self._y[1] + m.C @ (m.A @ self.x + m.B @ self._u[0]) + m.D @ self._u[1]
            np.take(rate.ravel(), self._out, out=self._rates)

    def read_all(self, values: Vector) -> None:
        values[:] = (self._y[0] + self._linear.C @ self.x + self._linear.D @ self._u[0]).ravel()

    def save(self) -> tuple[Vector, ...]:
        return self.x.copy(), self._u.copy(), self._y.copy()

    def restore(self, saved: tuple[Vector, ...]) -> None:
        self.x[:], self._u[:], self._y[:] = saved

    def release(self, saved: tuple[Vector, ...]) -> None:
        pass

    def to_bytes(self, saved: tuple[Vector, ...]) -> NoReturn:
        raise CannotSerializeError(f"{self.name}: {self.abilities.unserialisable}")

    def from_bytes(self, data: bytes) -> NoReturn:
        raise CannotSerializeError(f"{self.name}: {self.abilities.unserialisable}")

    def close(self) -> None:
        pass


def _find_columns(known: Sequence[str], names: Sequence[str], count: int) -> Any:
    """Positions of named copies in the flattened (variables x copies)."""
    places = []
    for name in names:
        own, _, copy = name.partition("#")
        places.append(known.index(own) * count + int(copy or 0))
    return np.array(places, dtype=np.int64)


class LinearCoupling:
    """`count` copies of a system of linear participants, coupled by signals of one degree.

    `configure` sets the matrices. The copies of an exchanged value are adjacent.
    """

    def __init__(
        self, system: System, degree: int, watched: Mapping[str, Sequence[str]] | None = None, count: int = 1
    ) -> None:
        self.system, self.degree, self.count = system, degree, count
        self._linears: Mapping[str, Linear] | None = None
        names = {
            name: [copy for variable in variables for copy in name_copies(variable, count)]
            for name, variables in (watched or {}).items()
        }
        self.units = {
            name: LinearParticipant(name, instance, _build_static(instance.component), count)
            for name, instance in system.instances.items()
        }
        # BatchedSystem has all of a System that a coupling uses.
        self.coupling = Coupling(cast(System, BatchedSystem(system, count)), self.units, degree, names)
        self.coupling.initialise(0.0, 1.0)
        self.sources = len(self.coupling.wiring.sources) // count
        self.nominal = self.coupling.wiring.nominal[::count]
        self.rated, self.rows = degree == HERMITE, NEEDED[degree]
        self.degrees = np.full(self.sources, degree)  # of the exchanged values' signals

    def configure(self, linears: Mapping[str, Linear], master: Master) -> None:
        """Set the matrices and the master."""
        if self._linears is not linears:
            self._linears = linears
            for name, unit in self.units.items():
                unit.set_matrices(linears[name])
            self._limit_degrees(linears)
            self.scales = {name: linears[name].scale[:, None] for name in self.units}
            self.states = sum(len(scale) for scale in self.scales.values())

    def _limit_degrees(self, linears: Mapping[str, Linear]) -> None:
        """Limit each signal to the degree that its participants follow."""
        followed = {c.target: self._find_highest_degree(linears, c.target) for c in self.system.connections}
        self.degrees[:] = self.degree
        degrees = find_highest_degrees(self.system.connections, followed)
        self.highest = max(degrees.values(), default=HIGHEST)
        for port, degree in degrees.items():
            first = Port(port.instance, name_copies(port.variable, self.count)[0])
            source = self.coupling.wiring.number[first] // self.count
            self.degrees[source] = min(self.degree, degree)
        self.coupling.state.history.degrees[:] = np.repeat(self.degrees, self.count)

    def _find_highest_degree(self, linears: Mapping[str, Linear], target: Port) -> int:
        followed = linears[target.instance].followed
        if followed is None:
            return HIGHEST
        column = self.system.instances[target.instance].component.inputs.index(target.variable)
        return int(np.argmin(np.append(followed[1 : HIGHEST + 1, column] > 0.0, False)))

    @property
    def holds(self) -> bool:
        """Whether a participant holds a connected input."""
        linears = self._linears or {}
        targets = (c.target for c in self.system.connections)
        return any(self._find_highest_degree(linears, target) == 0 for target in targets)

    @property
    def size(self) -> int:
        """The size of the evolving data."""
        return self.states + self.rows * self.sources * (2 if self.rated else 1)

    def set_state(self, data: Vector, step: float) -> None:
        """Set the evolving data (size x copies) before a step from t = 0, with the trajectory at rest.

        Copies beyond `data` get zeros.
        """
        e, given = self.coupling, data.shape[1]
        first = 0
        for name, unit in self.units.items():
            unit.reset()
            scale = self.scales[name]
            unit.x[:, :given] = data[first : first + len(scale)] * scale
            first += len(scale)
        h, block = e.state.history, self.rows * self.sources
        h.times[:] = -step * np.arange(POINTS)
        h.values[:], h.rates[:], h.count = 0.0, 0.0, POINTS
        shape = (self.rows, self.sources, given)
        values = h.values.reshape(POINTS, self.sources, self.count)
        values[: self.rows, :, :given] = data[first : first + block].reshape(shape) * self.nominal[:, None]
        if self.rated:
            rates = h.rates.reshape(POINTS, self.sources, self.count)
            ends = data[first + block :].reshape(shape) * self.nominal[:, None] / step
            rates[: self.rows, :, :given] = ends
        e.state.values[:], e.state.rates[:] = h.values[0], h.rates[0]
        e.state.warm_starts = {}

    def step(self, master: Master, step: float) -> Vector:
        """Step by `master`; return the evolving data (size x copies). May raise NonConvergenceError."""
        e = self.coupling
        master.step(e, 0.0, step)
        e.accept(step)
        parts = [unit.x / self.scales[name] for name, unit in self.units.items()]
        shape = (POINTS * self.sources, self.count)
        block = self.rows * self.sources
        tiled = np.tile(self.nominal, self.rows)[:, None]
        parts.append(e.state.history.values.reshape(shape)[:block] / tiled)
        if self.rated:
            parts.append(e.state.history.rates.reshape(shape)[:block] * step / tiled)
        return np.concatenate(parts)

    def add_extrapolation_error(self, amounts: Vector, step: float) -> None:
        """Let the trajectory deviate from the extrapolated signals by `amounts` in the next step.

        Amounts are in nominal units, (shapes after shapes of exchanged values) x copies; before the shapes
        comes the change of the values over the step. Call after `set_state`.
        """
        e, given = self.coupling, amounts.shape[1]
        for number in np.flatnonzero(np.any(amounts, axis=1)):
            kind, source = divmod(int(number), self.sources)
            shapes_over_step, at_end = (
                build_shapes(step, self.degrees[source]),
                evaluate_ends(step, self.degrees[source]),
            )
            port = e.wiring.sources[source * self.count]
            variable = port.variable.partition("#")[0]
            if kind > len(shapes_over_step):  # this signal's degree is lower than others'
                continue
            error = self.nominal[source] * amounts[number]
            unit = self.units[port.instance]
            column = self.system.instances[port.instance].component.outputs.index(variable)
            if kind:
                unit.course_end[:, column, :given] += at_end[:, kind - 1, None] * error
            for c in self.system.connections:
                if c.source.instance == port.instance and c.source.variable == variable:
                    into = self.system.instances[c.target.instance].component.inputs.index(c.target.variable)
                    target = self.units[c.target.instance]
                    if kind:
                        target.trajectory[:, into, :given] += shapes_over_step[kind - 1][:, None] * error
                    else:
                        target.straight[into, :given] += error


def _build_static(component: Component) -> Linear:
    """Matrices of a participant with constant outputs."""
    n, m = component.outputs.size, component.inputs.size
    return Linear(np.zeros((0, 0)), np.zeros((0, m)), np.zeros((n, 0)), np.zeros((n, m)), np.zeros(0))
