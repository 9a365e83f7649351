"""A component alone, under inputs that are given: broken lines in time.

The two methods of the reference solve it. They restart at every corner of the inputs, where solutions lose
smoothness. The result does not depend on the component's own steps or on its FMU.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.component import Component
from ..core.integrator import taylor
from ..core.quantities import Vector
from ..core.system import ModelError
from .cvode import Cvode
from .march import Method, march
from .problem import Event
from .reference import SHARPER, SHARPEST, check_times, stiffness
from .runge_kutta import RungeKutta


@dataclass(frozen=True)
class Piece:
    """From `start` on (s) inputs are u + du (t - start), until the next piece begins."""

    start: float
    u: Vector
    du: Vector


@dataclass(frozen=True)
class Driven:
    """States and outputs at `times`, the rows, by the first method; how far the second one's outputs are."""

    times: Vector
    states: Vector
    outputs: Vector
    difference: Vector
    events: list[Event]
    method_names: tuple[str, str]


class DrivenProblem:
    """A component's state, with inputs along one piece; ModelError if the component is no ODE."""

    def __init__(self, component: Component, piece: Piece, p: Vector) -> None:
        if not component.ode:
            raise ModelError(f"{component.name}: has no form as ordinary differential equations")
        self.component, self.piece, self.p = component, piece, p
        self.nominal = component.state.nominal
        self.whole: NDArray[np.bool_] = np.array([f.quantity.discrete for f in component.state.fields])
        self.next_event = math.inf
        self.guard_count = component.events.count if component.events else 0
        self._U = np.zeros((4, component.inputs.size))
        self._U[0], self._U[1] = piece.u, piece.du
        self._u = np.zeros(component.inputs.size)
        self._rate = np.zeros(component.state.size)
        self._g = np.zeros(self.guard_count)

    def inputs(self, t: float) -> Vector:
        """The inputs at t."""
        taylor(self._U, t - self.piece.start, self._u)
        return self._u

    def rate(self, t: float, z: Vector) -> Vector:
        self.component.flat_derivative(t, z, self.inputs(t), self.p, self._rate)
        return self._rate

    def guards(self, t: float, z: Vector) -> Vector:
        if self.guard_count:
            self.component.flat_guards(t, z, self.inputs(t), self.p, self._g)
        return self._g

    def transition(self, guard: int, t: float, z: Vector) -> Event:
        self.component.flat_transition(guard, t, z, self.inputs(t), self.p)
        return Event(t, self.component.name, guard)

    def outputs(self, t: float, z: Vector) -> Vector:
        """The outputs at (t, z), a new vector."""
        y = np.zeros(self.component.outputs.size)
        self.component.flat_output(t, z, self.inputs(t), self.p, y)
        return y


def solve_driven(
    component: Component,
    pieces: Sequence[Piece],
    times: Vector,
    tolerance: float = 1e-10,
    p: Vector | None = None,
    x0: Vector | None = None,
) -> Driven:
    """Solve `component` at `times` (ascending) from its start `x0` at the first piece's start.

    CVODE, and DOP853 or Radau, both with location of events; `tolerance` as for `solve`. At an instant where
    inputs jump, outputs are those after it. ModelError if a method fails, for start states that do not fit,
    and for pieces whose starts do not ascend or lie after the first instant.
    """
    p = component.parameters.start.copy() if p is None else p
    x0 = component.state.start.copy() if x0 is None else x0
    times = check_times(times, pieces[0].start)
    starts = np.array([piece.start for piece in pieces])
    if np.any(np.diff(starts) <= 0.0):
        raise ModelError("pieces of inputs: their starts must ascend")
    if faults := component.start_faults(p, x0, pieces[0].u):
        raise ModelError("; ".join(faults))
    problems = [DrivenProblem(component, piece, p) for piece in pieces]
    place = np.searchsorted(starts, times, side="right") - 1
    runs = []
    for make in (Cvode, RungeKutta):
        states, events, name = _solve_pieces(problems, x0, times, make, max(SHARPER * tolerance, SHARPEST))
        at = zip(times, states, place, strict=True)
        runs.append((states, np.array([problems[i].outputs(float(t), z) for t, z, i in at]), events, name))
    (states, outputs, events, first), (_, others, _, second) = runs
    return Driven(times, states, outputs, np.abs(others - outputs), events, (first, second))


def _solve_pieces(
    problems: Sequence[DrivenProblem], x0: Vector, times: Vector, make: type[Cvode | RungeKutta], sharp: float
) -> tuple[Vector, list[Event], str]:
    """States at `times`, the events on the way and the method's name."""
    z, states, name = x0.copy(), np.empty((times.size, x0.size)), "no states"
    events: list[Event] = []
    if not x0.size:  # the outputs follow from the inputs alone
        return states, events, name
    for i, problem in enumerate(problems):
        t0 = problem.piece.start
        if t0 > times[-1]:
            break
        later = problems[i + 1].piece.start if i + 1 < len(problems) else math.inf
        inside = (times >= t0) & (times < later)
        targets = np.union1d(times[inside], [min(later, float(times[-1]))])
        stiff, longest = stiffness(problem, t0, z, targets)
        method: Method = make(problem, sharp, stiff, longest)
        name = method.name
        found, fallen = march(problem, method, z, t0, targets)
        states[inside] = found[: int(np.count_nonzero(inside))]
        z, events = found[-1].copy(), events + fallen
    return states, events, name
