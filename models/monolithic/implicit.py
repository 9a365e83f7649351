"""A whole system with components that are no ODE, as one implicit problem.

Carried together are the states of all other components, energies, and what the components of
`ImplicitSteps` carry: dZ/dt = F, of which a method solves (Z - base)/interval = F at one instant after the
other. There the others are solved for by Newton's method, as if the outputs of the fields were given, then
the fields for the inputs that follow, in turn until nothing changes: a field whose stiffness is K presses on
a mass m, and a turn leaves interval^2 K/m of a change, some 1e-3.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.component import Component
from ..core.errors import RunError
from ..core.evaluation import Evaluation
from ..core.implicit import ImplicitSteps
from ..core.integrator import FAILURES, OK
from ..core.quantities import Vector
from ..core.system import System
from .energy import QUADRATURES, Energies
from .problem import check_solvable, find_jacobian

# Newton's corrections of the states that are no field's end below this of nominal + |value|: a few roundings,
# as a contact's deflection is a small difference of large positions.
NEWTON_TOLERANCE = 1e-13
NEWTON_ITERATIONS = 20
# Iterations after which the Jacobian is made anew: one is enough where it is exact.
SLOW_ITERATIONS = 4
# Turns end when they leave less than this to change in the fields' outputs, relative to nominal + |value|: as
# little as the fields' own Newton method leaves.
TURN_TOLERANCE = 1e-8
TURNS = 30
# A turn is not counted on to leave less of a change than this.
LEAST_LEFT = 1e-2
# An inverse serves intervals that differ by less than this from its own.
SAME_INTERVAL = 1e-6
# Accepted points through which the next guess is extrapolated.
GUESS_POINTS = 3


@dataclass(frozen=True)
class Field:
    """An instance that is no ODE: where its parts lie."""

    name: str
    steps: ImplicitSteps
    state: slice
    inputs: slice
    carried: slice
    parameters: Vector
    work: Vector


class NotSolvedError(RunError):
    """A stage without a solution; the message says of what."""


class ImplicitProblem:
    """A system's full state x at an instant, from what is carried."""

    def __init__(self, system: System) -> None:
        check_solvable(system)
        self.system = s = system
        self.evaluation = Evaluation(s)
        self.energies = Energies(s)
        names = [name for name, instance in s.instances.items() if not instance.component.ode]
        others = np.ones(s.state.size, dtype=np.bool_)
        for name in names:
            others[s.state.of(name)] = False
        self.others: NDArray[np.int64] = np.flatnonzero(others)
        self._energy = slice(self.others.size, self.others.size + QUADRATURES * len(s.instances))
        self.size = self._energy.stop
        self.fields: list[Field] = []
        for name in names:
            steps = _steps(s.instances[name].component)
            carried = slice(self.size, self.size + steps.carried)
            parameters = s.p[s.parameters.of(name)]
            work = np.zeros(steps.work_size)
            self.fields.append(
                Field(name, steps, s.state.of(name), s.inputs.of(name), carried, parameters, work)
            )
            self.size = carried.stop
        shown = [s.outputs.of(field.name) for field in self.fields]
        sources = {int(k) for k in s.source_index if any(part.start <= k < part.stop for part in shown)}
        self._watched = np.array(sorted(sources), dtype=np.int64)
        self._nominal = s.state.nominal[self.others]
        self._watched_nominal = s.outputs.nominal[self._watched]
        # What a turn leaves of a change, as last seen.
        self._left = 1.0
        self._jacobian: Vector | None = None
        self._inverse: tuple[float, Vector] | None = None

    def start(self, t: float, x: Vector) -> tuple[Vector, Vector]:
        """The state with its fields ready for the first step, and what is carried there."""
        x = x.copy()
        self.evaluation.outputs(t, x)
        u = self.evaluation.u.copy()
        for field in self.fields:
            field.steps.begin(x[field.state], u[field.inputs], field.parameters, field.work)
        carried = np.zeros(self.size)
        carried[: self.others.size] = x[self.others]
        self._carry_fields(x, carried)
        return x, carried

    def energy(self, carried: Vector) -> Vector:
        """The energies' part of what is carried."""
        return carried[self._energy]

    def solve(self, t: float, guess: Vector, base: Vector, interval: float) -> tuple[Vector, Vector]:
        """x and what is carried at t, with (carried - base)/interval = F(t, x); NotSolvedError."""
        x = guess.copy()
        e = self.evaluation
        before = math.inf
        for _ in range(TURNS):
            self._solve_others(t, x, base, interval)
            assumed = e.outputs(t, x)[self._watched].copy()
            for field in self.fields:
                status = field.steps.stage(
                    x[field.state], e.u[field.inputs], field.parameters, base[field.carried], interval,
                    field.work,
                )  # fmt: skip
                if status != OK:
                    raise NotSolvedError(f"{field.name}: {FAILURES[status]}")
            found = e.outputs(t, x)[self._watched]
            changes = np.abs(found - assumed) / (self._watched_nominal + np.abs(found))
            change = float(np.max(changes, initial=0.0))
            if not math.isfinite(change):
                break
            if before < math.inf:
                self._left = max(LEAST_LEFT, change / before if before > 0.0 else 0.0)
            if change * self._left <= TURN_TOLERANCE:
                self._solve_others(t, x, base, interval)
                return x, self._carry(t, x, base, interval)
            before = change
        raise NotSolvedError(f"{', '.join(f.name for f in self.fields)}: no balance with what surrounds it")

    def _carry(self, t: float, x: Vector, base: Vector, interval: float) -> Vector:
        carried = np.empty(self.size)
        carried[: self.others.size] = x[self.others]
        e, powers = self.evaluation, np.empty(self._energy.stop - self._energy.start)
        e.outputs(t, x)
        self.energies.powers(t, x, e.u, e.y, powers)
        carried[self._energy] = base[self._energy] + interval * powers
        self._carry_fields(x, carried)
        return carried

    def _carry_fields(self, x: Vector, carried: Vector) -> None:
        for f in self.fields:
            f.steps.carry(x[f.state], self.evaluation.u[f.inputs], f.parameters, f.work, carried[f.carried])

    def _solve_others(self, t: float, x: Vector, base: Vector, interval: float) -> None:
        """The states of no field, with the fields as they are in x."""
        n = self.others.size
        for iteration in range(NEWTON_ITERATIONS):
            rate = self.evaluation.derivative(t, x)[self.others]
            missing = base[:n] + interval * rate - x[self.others]
            correction = self._invert(t, x, interval, iteration == SLOW_ITERATIONS) @ missing
            if not np.all(np.isfinite(correction)):
                break
            x[self.others] += correction
            if np.all(np.abs(correction) <= NEWTON_TOLERANCE * (self._nominal + np.abs(x[self.others]))):
                return
        raise NotSolvedError("no solution for the states that are no field's")

    def _invert(self, t: float, x: Vector, interval: float, anew: bool) -> Vector:
        """The inverse of 1 - interval * Jacobian, by differences at some earlier state."""
        if self._jacobian is None or anew:
            whole = x.copy()

            def rate(others: Vector) -> Vector:
                whole[self.others] = others
                return self.evaluation.derivative(t, whole)[self.others]

            self._jacobian = find_jacobian(rate, x[self.others], self._nominal)
            self._inverse = None
        if self._inverse is None or abs(self._inverse[0] - interval) > SAME_INTERVAL * interval:
            inverse = np.linalg.inv(np.eye(self.others.size) - interval * self._jacobian)
            self._inverse = (interval, np.asarray(inverse, dtype=np.float64))
        return self._inverse[1]


def _steps(component: Component) -> ImplicitSteps:
    assert component.implicit is not None  # check_solvable
    return component.implicit
