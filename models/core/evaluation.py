"""Outputs, inputs and derivatives of a whole system at an instant."""

from functools import cache
from typing import Any

import numpy as np

from ..compile.array_pointers import ArrayPointers, integer_table, integers, numbers
from ..compile.kernel import kernel
from .composition import Composition, Tables
from .quantities import Vector
from .system import ModelError, System, alike, bounds

# Algebraic loops are closed to this share of nominal + |value|. Those of our components are linear in torn
# outputs: one iteration of Newton's method does it, or three turns of the secant.
LOOP_TOLERANCE = 1e-12
LOOP_ITERATIONS = 20
TURNS = 4


class Interpreted:
    """Evaluates instance after instance: for few instants, where compiling the whole would take longer.

    After `outputs(t, x)` or `derivative(t, x)`, `u` and `y` hold all inputs and outputs. ModelError where
    Newton's method finds no values for the torn outputs of algebraic loops, with slopes by differences over
    `probe` times nominal. It begins with the last outputs, or with zero where these are not finite.
    """

    probe = 1.0

    def __init__(self, system: System) -> None:
        self.system = s = system
        self.u = s.u0.copy()
        self.y = np.zeros(s.outputs.size)
        self.dx = np.zeros(s.state.size)
        self._torn, (self._number, self._cut) = s.torn_index, s.cuts
        self._nominal: Vector = s.outputs.nominal[self._torn]
        self._guess: Vector = np.zeros(self._torn.size)

    def outputs(self, t: float, x: Vector) -> Vector:
        """All outputs at (t, x); shared memory, overwritten by the next call."""
        self._guess[:] = self.y[self._torn]
        self.close_loops(t, x)
        self.u[self.system.target_index] = self.y[self.system.source_index]
        return self.y

    def derivative(self, t: float, x: Vector) -> Vector:
        """dx/dt at (t, x); shared memory, overwritten by the next call."""
        self.outputs(t, x)
        s = self.system
        for name, instance in s.instances.items():
            own = x[s.state.of(name)], self.u[s.inputs.of(name)], s.p[s.parameters.of(name)]
            instance.component.flat_derivative(t, *own, self.dx[s.state.of(name)])
        return self.dx

    def close_loops(self, t: float, x: Vector) -> None:
        """Newton's method on the torn outputs, from the guess."""
        self._guess[~np.isfinite(self._guess)] = 0.0
        residual = self._residual(t, x, self._guess)
        for _ in range(LOOP_ITERATIONS):
            if self._is_closed(residual):
                return
            columns = []
            for i, size in enumerate(self._nominal):
                moved = self._guess.copy()
                moved[i] += self.probe * size
                columns.append((self._residual(t, x, moved) - residual) / (self.probe * size))
            try:
                self._guess -= np.linalg.solve(np.column_stack(columns), residual)
            except np.linalg.LinAlgError:  # a gain of one
                break
            residual = self._residual(t, x, self._guess)
        raise ModelError(f"algebraic loop through {self.system.loops()}: no solution at t = {t:g} s")

    def _is_closed(self, residual: Vector) -> bool:
        """Also where it is not finite: an integrator rejects such a state."""
        small = np.abs(residual) <= LOOP_TOLERANCE * (self._nominal + np.abs(self._guess))
        return bool(np.all(small) or not np.all(np.isfinite(residual)))

    def _residual(self, t: float, x: Vector, assumed: Vector) -> Vector:
        self.u[self._cut] = assumed[self._number]
        self._evaluate(t, x)
        return np.asarray(self.y[self._torn] - assumed)

    def _evaluate(self, t: float, x: Vector) -> None:
        s = self.system
        source, target = s.wires
        for name in s.order:
            self.u[target] = self.y[source]
            own = x[s.state.of(name)], self.u[s.inputs.of(name)], s.p[s.parameters.of(name)]
            s.instances[name].component.flat_output(t, *own, self.y[s.outputs.of(name)])


class Evaluation(Interpreted):
    """Evaluates all instances in one call of compiled code.

    `flat_outputs(t, x, memory.record)` is False where algebraic loops are left to `close_loops`;
    `flat_derivative(t, x, memory.record)` follows closed outputs. Python calls `along` alone, so that the
    outputs are compiled for it once.
    """

    def __init__(self, system: System) -> None:
        super().__init__(system)
        s = system
        names = alike(s.instances)
        outputs = Composition(
            [s.instances[name].component.flat_output for name in s.order],
            [bounds(name, s.state, s.inputs, s.parameters, s.outputs) for name in s.order],
            *s.wires,
        )
        derivatives = Composition(
            [s.instances[name].component.flat_derivative for name in names],
            [bounds(name, s.state, s.inputs, s.parameters, s.state) for name in names],
        )
        self._composition = outputs
        self.memory = ArrayPointers(
            u=self.u, y=self.y, dx=self.dx, p=s.p,
            torn=self._torn, nominal=self._nominal, guess=self._guess, number=self._number, cut=self._cut,
            source=s.source_index, target=s.target_index, wires=outputs.source, ends=outputs.target,
            none=derivatives.source,
            output_bounds=outputs.bounds, output_ends=outputs.ends,
            derivative_bounds=derivatives.bounds, derivative_ends=derivatives.ends,
        )  # fmt: skip
        self.flat_outputs = make_outputs(outputs.run)
        self.flat_derivative = make_derivative(derivatives.run)
        self._along = make_along(self.flat_outputs)
        self._instant = np.zeros(1)
        self._one = self._instant, self.u[None], self.y[None]

    def outputs(self, t: float, x: Vector) -> Vector:
        x = np.ascontiguousarray(x)
        self._instant[0] = t
        times, inputs, outputs = self._one
        if not self._along(0, times, x[None], self.memory.record, inputs, outputs):
            self.close_loops(t, x)
        return self.y

    def along(self, times: Vector, states: Vector) -> tuple[Vector, Vector]:
        """Inputs (n, n_in) and outputs (n, n_out) at `times`; each row begins with the state."""
        s = self.system
        inputs, outputs = np.empty((times.size, s.inputs.size)), np.empty((times.size, s.outputs.size))
        rows = np.ascontiguousarray(states)
        row = 0
        while (row := self._along(row, times, rows, self.memory.record, inputs, outputs)) < times.size:
            self.close_loops(float(times[row]), rows[row, : s.state.size])
            inputs[row], outputs[row] = self.u, self.y
            row += 1
        return inputs, outputs

    def derivative(self, t: float, x: Vector) -> Vector:
        x = np.ascontiguousarray(x)
        self.outputs(t, x)
        self.flat_derivative(t, x, self.memory.record)
        return self.dx

    def close_loops(self, t: float, x: Vector) -> None:
        super().close_loops(t, x)
        self.u[self.system.target_index] = self.y[self.system.source_index]

    def _evaluate(self, t: float, x: Vector) -> None:
        self._composition(t, x, self.u, self.system.p, self.y)


@cache
def make_outputs(run: Any) -> Any:
    """outputs(t, x, memory) -> whether all algebraic loops are closed: u and y are then those at (t, x).

    A single loop is closed by the secant. What was assumed before is not taken as it is, so that outputs
    do not depend on the instant before.
    """

    @kernel
    def outputs(t: float, x: Any, memory: Any) -> bool:
        m = memory[0]
        u, y, source, target = numbers(m.u), numbers(m.y), integers(m.source), integers(m.target)
        torn, nominal, guess = integers(m.torn), numbers(m.nominal), numbers(m.guess)
        number, cut = integers(m.number), integers(m.cut)
        for i in range(torn.shape[0]):
            last = y[torn[i]]
            guess[i] = last if last - last == 0.0 else 0.0
        bounds, ends = integer_table(m.output_bounds), integers(m.output_ends)
        tables = Tables(integers(m.wires), integers(m.ends), bounds, ends)
        closed, answer, change = False, 0.0, 0.0
        for turn in range(TURNS):
            for k in range(cut.shape[0]):
                u[cut[k]] = guess[number[k]]
            run(t, x, u, numbers(m.p), y, tables, 0)
            closed, finite, residual = True, True, 0.0
            tolerance = LOOP_TOLERANCE if turn else 0.0
            for i in range(torn.shape[0]):
                residual = y[torn[i]] - guess[i]
                finite = finite and residual - residual == 0.0
                closed = closed and abs(residual) <= tolerance * (nominal[i] + abs(guess[i]))
            closed = closed or (turn == 0 and not finite)
            if closed or torn.shape[0] > 1:
                break
            gain = (y[torn[0]] - answer) / change if turn else 0.0
            answer = y[torn[0]]
            change = residual / (1.0 - gain)
            guess[0] = answer + gain * change
        for k in range(source.shape[0]):
            u[target[k]] = y[source[k]]
        return closed

    return outputs


@cache
def make_along(outputs: Any) -> Any:
    """along(first, times, states, memory, u, y): inputs and outputs of the rows from `first`; the row with
    algebraic loops that are left open, or the number of rows."""

    @kernel
    def along(first: int, times: Any, states: Any, memory: Any, inputs: Any, values: Any) -> int:
        m = memory[0]
        u, y = numbers(m.u), numbers(m.y)
        for k in range(first, times.shape[0]):
            if not outputs(times[k], states[k], memory):
                return k
            for i in range(u.shape[0]):
                inputs[k, i] = u[i]
            for i in range(y.shape[0]):
                values[k, i] = y[i]
        return times.shape[0]

    return along


@cache
def make_derivative(run: Any) -> Any:
    """derivative(t, x, memory): dx, with the inputs of the last `outputs`."""

    @kernel
    def derivative(t: float, x: Any, memory: Any) -> None:
        m = memory[0]
        none = integers(m.none)
        tables = Tables(none, none, integer_table(m.derivative_bounds), integers(m.derivative_ends))
        run(t, x, numbers(m.u), numbers(m.p), numbers(m.dx), tables, 0)

    return derivative


def check_start(system: System, t: float, x: Vector) -> None:
    """ModelError if an instance's part of the state x does not fit the inputs that it has at `t`."""
    judging = {n: i.component for n, i in system.instances.items() if i.component.start_requirements}
    if not judging:
        return
    evaluation = Interpreted(system)
    evaluation.outputs(t, x)
    faults: list[str] = []
    for name, component in judging.items():
        parts = system.p[system.parameters.of(name)], x[system.state.of(name)]
        found = component.start_faults(*parts, evaluation.u[system.inputs.of(name)])
        faults += [f"components.{name}.start.{fault}" for fault in found]
    if faults:
        raise ModelError("; ".join(faults))
