"""Derivatives of a whole system: how rates, inputs and outputs change with states and parameters.

Tangents of the components' kernels one after the other, in the order in which outputs are computed. Slopes d
of the torn outputs of algebraic loops solve d = r + J d: r with the assumed values at rest, J by these alone.
"""

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from ..compile.array_pointers import numbers
from ..compile.kernel import kernel
from ..core.evaluation import Evaluation
from ..core.quantities import Vector
from ..core.system import ModelError, System, alike, bounds
from ..native.tangents import call_tangent, find_tangents


class Slopes:
    """Of a system in directions: one for each state by itself, then changes of parameters by their `shares`.

    `parameters[k]` are the places and shares of the k-th of these, in the vector of all parameters.
    """

    def __init__(self, system: System, parameters: Sequence[Sequence[tuple[int, float]]]) -> None:
        s = self.system = system
        self.evaluation = Evaluation(system)
        self.count = s.state.size + len(parameters)
        self.steps = np.zeros((len(parameters), s.p.size))
        for k, changes in enumerate(parameters):
            for place, share in changes:
                self.steps[k, place] = share
        names = list(s.instances)
        # Kept: the addresses are theirs.
        self._tangents = dict(
            zip(names, find_tangents([s.instances[n].component for n in names]), strict=True)
        )
        outputs = [(n, "output", s.outputs) for n in s.order]
        rates = [(n, "derivative", s.state) for n in alike(s.instances)]
        calls = [*outputs, *rates]
        self._addresses = np.array(
            [self._tangents[n].address[entry] for n, entry, _ in calls], dtype=np.int64
        )
        self._bounds = np.array([bounds(n, s.state, s.inputs, s.parameters, into) for n, _, into in calls])
        self._outputs = len(outputs)
        self._room = np.zeros(s.inputs.size), np.zeros(s.outputs.size), np.zeros(s.state.size)
        self._rates = make_rates(self.evaluation.flat_outputs, self.evaluation.flat_derivative)

    def rates(self, times: Vector, states: Vector) -> Vector:
        """At k instants, (k, n)."""
        e, states, found, row = self.evaluation, np.ascontiguousarray(states), np.empty(states.shape), 0
        while (row := self._rates(row, times, states, e.memory.record, found)) < times.size:
            found[row] = e.derivative(float(times[row]), states[row])
            row += 1
        return found

    def at(self, times: Vector, states: Vector) -> Vector:
        """Slopes of the rates at k instants, (k, n, directions)."""
        n, m = self.system.state.size, self.count
        starts = np.vstack([np.eye(n), np.zeros((m - n, n))])
        steps = np.vstack([np.zeros((n, self.system.p.size)), self.steps])
        return self._fill(times, states, starts, steps)[0].transpose(0, 2, 1)

    def along(self, t: float, x: Vector, starts: Vector, steps: Vector) -> tuple[Vector, Vector, Vector]:
        """Of rates, inputs and outputs (directions, ...) where the state and the parameters so change."""
        rates, inputs, outputs = self._fill(np.array([t]), x[None], starts, steps)
        return rates[0], inputs[0], outputs[0]

    def _fill(
        self, times: Vector, states: Vector, starts: Vector, steps: Vector
    ) -> tuple[Vector, Vector, Vector]:
        s, k, m, torn = self.system, times.size, starts.shape[0], len(self.system.torn)
        states = np.ascontiguousarray(states)
        parts = s.state, s.inputs, s.outputs
        rates, inputs, outputs = (np.empty((k, m + torn, part.size)) for part in parts)
        u, y = self.evaluation.along(times, states)
        calls = self._addresses, self._bounds, self._outputs
        starts, steps = (np.vstack([given, np.zeros((torn, given.shape[1]))]) for given in (starts, steps))
        assumed = np.vstack([np.zeros((m, torn)), np.eye(torn)])
        for row in range(k):
            fill(
                times[row], states[row], u[row], s.p, y[row], starts, steps, assumed, calls, s.wires, s.cuts,
                self._room, rates[row], inputs[row], outputs[row],
            )  # fmt: skip
        answers = outputs[:, :, s.torn_index]
        try:
            d = answers[:, :m] @ np.linalg.inv(np.eye(torn) - answers[:, m:])
        except np.linalg.LinAlgError:
            raise ModelError(
                f"algebraic loop through {s.loops()}: with a gain of one no derivative"
            ) from None
        for part in (rates, inputs, outputs):
            part[:, :m] += d @ part[:, m:]
        return rates[:, :m], inputs[:, :m], outputs[:, :m]


@cache
def make_rates(outputs: Any, derivative: Any) -> Any:
    """rates(first, times, states, memory, found): of the rows from `first`; the row with algebraic loops that
    are left open, or the number of rows."""

    @kernel
    def rates(first: int, times: Any, states: Any, memory: Any, found: Any) -> int:
        dx = numbers(memory[0].dx)
        for k in range(first, times.shape[0]):
            if not outputs(times[k], states[k], memory):
                return k
            derivative(times[k], states[k], memory)
            for i in range(dx.shape[0]):
                found[k, i] = dx[i]
        return times.shape[0]

    return rates


@kernel
def fill(  # noqa: PLR0913  # a kernel
    t: float, x: Any, u: Any, p: Any, y: Any, starts: Any, steps: Any, assumed: Any, calls: Any, wires: Any,
    cuts: Any, room: Any, rates: Any, inputs: Any, outputs: Any,
) -> None:  # fmt: skip
    """By direction the slopes of rates, inputs and outputs, with `assumed` slopes of torn outputs."""
    du, dy, dx = room
    source, target = wires
    number, cut = cuts
    addresses, parts, first = calls
    for k in range(starts.shape[0]):
        for i in range(dy.shape[0]):
            dy[i] = 0.0
        for i in range(cut.shape[0]):
            du[cut[i]] = assumed[k, number[i]]
        for c in range(first):
            for i in range(source.shape[0]):
                u[target[i]], du[target[i]] = y[source[i]], dy[source[i]]
            call(addresses[c], t, x, starts[k], u, du, p, steps[k], y, dy, parts[c])
        for i in range(source.shape[0]):
            u[target[i]], du[target[i]] = y[source[i]], dy[source[i]]
        for c in range(first, addresses.shape[0]):
            call(addresses[c], t, x, starts[k], u, du, p, steps[k], dx, rates[k], parts[c])
        for i in range(du.shape[0]):
            inputs[k, i] = du[i]
        for i in range(dy.shape[0]):
            outputs[k, i] = dy[i]


@kernel
def call(  # noqa: PLR0913  # a kernel
    address: int, t: float, x: Any, dx: Any, u: Any, du: Any, p: Any, dp: Any, y: Any, dy: Any, b: Any
) -> None:
    """What nothing that it depends on changes does not change."""
    if rests(dx, b[0], b[1]) and rests(du, b[2], b[3]) and rests(dp, b[4], b[5]):
        for i in range(b[6], b[7]):
            dy[i] = 0.0
        return
    places = (
        place(x, b[0]), place(dx, b[0]), place(u, b[2]), place(du, b[2]), place(p, b[4]), place(dp, b[4]),
        place(y, b[6]), place(dy, b[6]),
    )  # fmt: skip
    call_tangent(address, t, places)


@kernel
def rests(change: Any, start: int, end: int) -> bool:
    found = True
    for i in range(start, end):
        found = found and change[i] == 0.0
    return found


@kernel
def place(vector: Any, start: int) -> Any:
    return np.int64(vector.ctypes.data) + 8 * start
