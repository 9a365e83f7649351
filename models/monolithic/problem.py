"""What the two methods integrate: an initial value problem with events, and a System as one."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..compile.array_pointers import numbers
from ..compile.kernel import kernel
from ..core.component import Component
from ..core.evaluation import Evaluation
from ..core.quantities import Vector
from ..core.system import ModelError, System
from .energy import QUADRATURES, Energies

# The number of the guard of an event that is known in advance.
TIME_EVENT = -1


@dataclass(frozen=True)
class Event:
    """A guard of an instance that has fallen below zero (see `component.Events`)."""

    time: float
    instance: str
    guard: int


class Problem(Protocol):
    """dz/dt = rate(t, z) between events; `nominal` is the size of z, `guard_count` may be zero.

    `whole` marks the elements of z that are whole numbers (modes, counts) and change in transitions only.
    `next_event` is the time (s) of the next known event, infinite for none: no rate is asked for behind it,
    and `transition` is called there for the guard TIME_EVENT.
    """

    nominal: Vector
    whole: NDArray[np.bool_]
    guard_count: int

    @property
    def next_event(self) -> float: ...

    def rate(self, t: float, z: Vector) -> Vector: ...

    def guards(self, t: float, z: Vector) -> Vector: ...

    def transition(self, guard: int, t: float, z: Vector) -> Event:
        """Change z in place because `guard` has fallen."""


class CompiledProblem(Problem, Protocol):
    """A problem with a compiled rate.

    flat_rate(t, z, *memory, rate) is False where algebraic loops are left open, which `rate` closes.
    """

    flat_rate: Any
    memory: tuple[Any, Any]


def find_jacobian(rate: Callable[[Vector], Vector], x: Vector, sizes: Vector) -> Vector:
    """d(rate)/dx by differences over 1e-7 of x or of its size."""
    base, columns = rate(x).copy(), []
    for j in range(x.size):
        moved = x.copy()
        moved[j] += 1e-7 * max(sizes[j], abs(x[j]))
        columns.append((rate(moved) - base) / (moved[j] - x[j]))
    return np.column_stack(columns) if columns else np.zeros((0, 0))


def find_central_jacobian(rate: Callable[[Vector], Vector], x: Vector, sizes: Vector) -> Vector:
    """The same by differences to both sides, whose errors of first order cancel."""
    mirrored = find_jacobian(lambda moved: rate(2.0 * x - moved), x, sizes)
    return 0.5 * (find_jacobian(rate, x, sizes) - mirrored)


def check_ode(system: System) -> None:
    """ModelError if a component's motion is not that of its derivative (`Component.ode`)."""
    for name, instance in system.instances.items():
        if not instance.component.ode:
            raise ModelError(
                f"{name}: {instance.component.name} with {_sizes(instance.component)} has no form as "
                "ordinary differential equations, which this solver needs (its own steps move it); "
                "leave the reference out (reference.enabled = false), or give it another structure"
            )


def check_solvable(system: System) -> None:
    """ModelError if the reference cannot be solved: see `check_ode` and `implicit`."""
    others = [name for name, instance in system.instances.items() if not instance.component.ode]
    if any(system.instances[name].component.opaque for name in others):
        check_ode(system)
    for name, instance in system.instances.items():
        if others and instance.component.events:
            raise ModelError(
                f"{name}: {instance.component.name} has events, which the reference of a system with "
                f"{', '.join(others)} ({_sizes(system.instances[others[0]].component)}) does not locate; "
                "leave the reference out (reference.enabled = false), or take a film formula"
            )


def _sizes(component: Component) -> str:
    sizes = [f"{name} = {size}" for name, size in component.structure.items() if size]
    return ", ".join(sizes) or "its own advance"


class SystemProblem:
    """A system's state, followed by the energies that its components dissipate, supply and receive, if asked.

    ModelError if a component is no ODE.
    """

    next_event = math.inf

    def __init__(self, system: System, counts_energies: bool = True) -> None:
        check_ode(system)
        self.system = system
        self.evaluation = Evaluation(system)
        self.energies = Energies(system, None if counts_energies else ())
        self.size = system.state.size
        quadratures = QUADRATURES * len(self.energies.instances)
        self.nominal = np.concatenate([system.state.nominal, np.ones(quadratures)])
        fields = [f for i in system.instances.values() for f in i.component.state.fields]
        self.whole = np.array([f.quantity.discrete for f in fields] + [False] * quadratures)
        self._rate = np.zeros(self.size + quadratures)
        self.flat_rate, self._end_rate = _make_rate(self.evaluation, self.energies, self.size)
        self.memory = self.evaluation.memory.record, self.energies.memory.record
        self._guards = [
            (name, guard)
            for name, instance in system.instances.items()
            if instance.component.events
            for guard in range(instance.component.events.count)
        ]
        self.guard_count = len(self._guards)
        self._g = np.zeros(self.guard_count)

    def start(self, x0: Vector) -> Vector:
        """The problem's z for the system's state x0."""
        if x0.shape != (self.size,):
            raise ModelError(f"start state of {x0.size} elements: the system has {self.size} states")
        return np.concatenate([x0, np.zeros(self.nominal.size - self.size)])

    def take(self, system: System) -> None:
        """Go on with the values of another system of the same components and connections."""
        self.system.p[:], self.evaluation.u[:], self.evaluation.y[:] = system.p, system.u0, 0.0

    def rate(self, t: float, z: Vector) -> Vector:
        if not self.flat_rate(t, z, *self.memory, self._rate):
            self.evaluation.close_loops(t, z[: self.size])
            self._end_rate(t, z, *self.memory, self._rate)
        return self._rate

    def guards(self, t: float, z: Vector) -> Vector:
        s = self.system
        self.evaluation.outputs(t, z[: self.size])
        u, start = self.evaluation.u, 0
        for name, instance in s.instances.items():
            component = instance.component
            if component.events:
                part = self._g[start : start + component.events.count]
                x = z[s.state.of(name)]
                component.flat_guards(t, x, u[s.inputs.of(name)], s.p[s.parameters.of(name)], part)
                start += component.events.count
        return self._g

    def transition(self, guard: int, t: float, z: Vector) -> Event:
        s = self.system
        name, k = self._guards[guard]
        self.evaluation.outputs(t, z[: self.size])
        u = self.evaluation.u[s.inputs.of(name)]
        s.instances[name].component.flat_transition(k, t, z[s.state.of(name)], u, s.p[s.parameters.of(name)])
        return Event(t, name, k)


def _make_rate(evaluation: Evaluation, energies: Energies, size: int) -> tuple[Any, Any]:
    """begin(t, z, memory, energy_memory, rate) -> bool, and end(...) after loops that `begin` leaves open."""
    outputs, derivative, powers = evaluation.flat_outputs, evaluation.flat_derivative, energies.flat_powers

    @kernel
    def end(t: float, z: Any, memory: Any, energy_memory: Any, rate: Any) -> None:
        x, m = z[:size], memory[0]
        derivative(t, x, memory)
        dx = numbers(m.dx)
        for i in range(size):
            rate[i] = dx[i]
        powers(t, x, numbers(m.u), numbers(m.p), numbers(m.y), energy_memory, rate[size:])

    @kernel
    def begin(t: float, z: Any, memory: Any, energy_memory: Any, rate: Any) -> bool:
        if not outputs(t, z[:size], memory):
            return False
        end(t, z, memory, energy_memory, rate)
        return True

    return begin, end
