"""The equations of a system with FMUs for model exchange, solved together without splitting.

FMUs give x' = f(t, x, u), y = g(t, x, u) and event indicators; components of ours take part with their own
kernels. At an event of any part all FMUs go to event mode and iterate until no output changes any more.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from models.core.evaluation import Interpreted
from models.core.quantities import Field, Quantity, Vector
from models.core.system import Instance, ModelError, System
from models.monolithic.cvode import Cvode
from models.monolithic.march import march
from models.monolithic.problem import TIME_EVENT, Event
from models.monolithic.reference import SHARPER, SHARPEST, half, stiffness
from models.monolithic.runge_kutta import RungeKutta

from ...errors import EndedError
from ..third_party import NamedLayout
from ..wrapping import Linear
from .crossing import cross, leave_zeros
from .in_own_process import FmuEquations

# Event iterations after which the system is taken to be stuck.
MOST_ITERATIONS = 1000
# Instants so near to each other (relative) are the same.
SAME_TIME = 1e-12

# Opens the equations of every FMU, by instance.
Open = Callable[[], Mapping[str, FmuEquations]]
Transformations = Mapping[str, Mapping[str, Linear]]


def _transform(names: Sequence[str], linear: Mapping[str, Linear]) -> tuple[Vector, Vector]:
    """Factors and offsets of these inputs."""
    own = [linear.get(name, Linear()) for name in names]
    return np.array([one.factor for one in own]), np.array([one.offset for one in own])


class ComponentPart:
    """A component of ours, whose inputs are `linear` functions of what they are connected to."""

    def __init__(self, instance: Instance, p: Vector, linear: Mapping[str, Linear]) -> None:
        component = instance.component
        self.component, self._p = component, p
        self._factors, self._offsets = _transform(component.inputs.names, linear)
        self.guard_count = component.events.count if component.events else 0

    def outputs(self, t: float, x: Vector, u: Vector, y: Vector) -> None:
        self.component.flat_output(t, x, self._transform(u), self._p, y)

    def rate(self, t: float, x: Vector, u: Vector, dx: Vector) -> None:
        self.component.flat_derivative(t, x, self._transform(u), self._p, dx)

    def guards(self, t: float, x: Vector, u: Vector, g: Vector) -> None:
        if self.guard_count:
            self.component.flat_guards(t, x, self._transform(u), self._p, g)

    def transition(self, guard: int, t: float, x: Vector, u: Vector) -> None:
        """Change x in place because `guard` has fallen."""
        self.component.flat_transition(guard, t, x, self._transform(u), self._p)

    def _transform(self, u: Vector) -> Vector:
        return np.asarray(self._factors * u + self._offsets)


class FmuPart:
    """An FMU; `driven` are the numbers of its driven inputs, which `linear` functions give."""

    def __init__(self, equations: FmuEquations, instance: Instance, linear: Mapping[str, Linear]) -> None:
        self.equations = equations
        self.guard_count = equations.indicators
        names = instance.component.inputs.names
        self._driven = [i for i, name in enumerate(names) if name not in instance.inputs]
        self._factors, self._offsets = _transform([names[i] for i in self._driven], linear)
        self._given: Vector | None = None

    def outputs(self, t: float, x: Vector, u: Vector, y: Vector) -> None:
        driven = self._factors * u[self._driven] + self._offsets
        self._given = np.concatenate([[t], x, u])
        y[:] = self.equations.outputs(t, x, driven)

    def deliver(self, t: float, x: Vector, u: Vector, y: Vector) -> None:
        """Give it these inputs, if they are not what it was given last."""
        if self._given is None or not np.array_equal(self._given, np.concatenate([[t], x, u])):
            self.outputs(t, x, u, y)

    def rate(self, t: float, x: Vector, u: Vector, dx: Vector) -> None:
        dx[:] = self.equations.rate()

    def guards(self, t: float, x: Vector, u: Vector, g: Vector) -> None:
        if self.guard_count:
            g[:] = self.equations.guards()

    def forget(self) -> None:
        """What it was given last holds no longer: its mode has changed."""
        self._given = None


Part = ComponentPart | FmuPart


class PartwiseEvaluation(Interpreted):
    """The system's outputs and derivatives from its parts."""

    # Loops through third-party FMUs need not be linear.
    probe = 1e-6

    def __init__(self, system: System, parts: Mapping[str, Part]) -> None:
        super().__init__(system)
        self._parts = parts

    def outputs(self, t: float, x: Vector) -> Vector:
        super().outputs(t, x)
        s = self.system
        for name, part in self._parts.items():
            if isinstance(part, FmuPart):
                part.deliver(t, x[s.state.of(name)], self.u[s.inputs.of(name)], self.y[s.outputs.of(name)])
        return self.y

    def derivative(self, t: float, x: Vector) -> Vector:
        self.outputs(t, x)
        s = self.system
        for name, part in self._parts.items():
            own = s.state.of(name)
            part.rate(t, x[own], self.u[s.inputs.of(name)], self.dx[own])
        return self.dx

    def _evaluate(self, t: float, x: Vector) -> None:
        s = self.system
        source, target = s.wires
        for name in s.order:
            self.u[target] = self.y[source]
            own = x[s.state.of(name)], self.u[s.inputs.of(name)], self.y[s.outputs.of(name)]
            self._parts[name].outputs(t, *own)


class PartwiseProblem:
    """Implements `Problem` for a system with FMUs; `equations` are theirs, by instance."""

    def __init__(
        self, system: System, equations: Mapping[str, FmuEquations], linear: Transformations
    ) -> None:
        self.system = s = _with_exchange_states(system, equations)
        self.parts: dict[str, Part] = {}
        for name, instance in s.instances.items():
            transformed = linear.get(name, {})
            if name in equations:
                self.parts[name] = FmuPart(equations[name], instance, transformed)
            else:
                self.parts[name] = ComponentPart(instance, s.p[s.parameters.of(name)], transformed)
        self._fmus = {name: part for name, part in self.parts.items() if isinstance(part, FmuPart)}
        self.evaluation = PartwiseEvaluation(s, self.parts)
        # Solvers need a state: a constant where the system has none.
        self.nominal = np.ones(max(s.state.size, 1))
        self.nominal[: s.state.size] = s.state.nominal
        fields = [f for i in s.instances.values() for f in i.component.state.fields]
        self.whole = np.array([f.quantity.discrete for f in fields] or [False])
        self._owners = [(name, k) for name, part in self.parts.items() for k in range(part.guard_count)]
        self.guard_count = len(self._owners)
        self._g, self._rate = np.zeros(self.guard_count), np.zeros(self.nominal.size)
        self._next = dict.fromkeys(self._fmus, math.inf)
        self._asked = math.inf

    @property
    def next_event(self) -> float:
        return min([self._asked, *self._next.values()])

    def start(self, t: float, stop: float) -> Vector:
        """Initialise the FMUs; the state at the start."""
        self._stop = stop
        z = np.zeros(self.nominal.size)
        z[: self.system.state.size] = self.system.x0
        for part in self._fmus.values():
            part.equations.initialise(t, stop)
        self.evaluation.outputs(t, z[: self.system.state.size])
        for part in self._fmus.values():
            part.equations.finish_initialisation()
        self._iterate_events(t, z)
        for name, part in self._fmus.items():
            self.nominal[self.system.state.of(name)] = part.equations.get_nominal()
        if (behind := leave_zeros(self, t, z)) > t:
            self._enter_events(behind, z)
        return z

    def rate(self, t: float, z: Vector) -> Vector:
        n = self.system.state.size
        self._rate[:n] = self.evaluation.derivative(t, np.ascontiguousarray(z[:n]))
        return self._rate

    def guards(self, t: float, z: Vector) -> Vector:
        s, end = self.system, 0
        self._observe(t, z)
        for name, part in self.parts.items():
            begin, end = end, end + part.guard_count
            own = z[s.state.of(name)], self.evaluation.u[s.inputs.of(name)]
            part.guards(t, *own, self._g[begin:end])
        return self._g

    def transition(self, guard: int, t: float, z: Vector) -> Event:
        s = self.system
        name, k = (
            self._owners[guard]
            if guard != TIME_EVENT
            else (min(self._next, key=self._next.__getitem__), guard)
        )
        part, behind = self.parts[name], t
        if isinstance(part, FmuPart):
            behind = cross(self, guard, t, z)
        self._observe(behind, z)
        if isinstance(part, ComponentPart):
            part.transition(k, t, z[s.state.of(name)], self.evaluation.u[s.inputs.of(name)])
        self._enter_events(behind, z)
        if (behind := leave_zeros(self, t, z)) > t:
            self._enter_events(behind, z)
        return Event(t, name, k)

    def _enter_events(self, t: float, z: Vector) -> None:
        self._observe(t, z)
        for fmu in self._fmus.values():
            fmu.equations.enter_events()
        self._iterate_events(t, z)

    def sample(self, t: float, z: Vector) -> Vector:
        """All outputs at (t, z), where a step of the integrator ends: an FMU may ask for an event."""
        outputs = self._observe(t, z).copy()
        asked = [self._ask(part.equations.complete_step) for part in self._fmus.values()]
        self._asked = t if any(asked) else math.inf
        return outputs

    def _observe(self, t: float, z: Vector) -> Vector:
        return self.evaluation.outputs(t, np.ascontiguousarray(z[: self.system.state.size]))

    def _iterate_events(self, t: float, z: Vector) -> None:
        """Iterate until nothing changes, all FMUs being in event mode, and take their states."""
        self._forget()
        for _ in range(MOST_ITERATIONS):
            before = self._observe(t, z).copy()
            again = [self._ask(part.equations.iterate) for part in self._fmus.values()]
            self._forget()
            if not any(again) and np.array_equal(self._observe(t, z), before, equal_nan=True):
                break
        else:
            raise ModelError(
                f"more than {MOST_ITERATIONS} event iterations at t = {t:.9g} s of {', '.join(self._fmus)}: "
                "each changes the inputs of another without end; set reference.method = 'refinement'"
            )
        for name, part in self._fmus.items():
            z[self.system.state.of(name)] = part.equations.get_states()
            self._next[name] = part.equations.leave_events()
        self._forget()
        self._asked = math.inf

    def _ask(self, call: Callable[[], bool]) -> bool:
        """What the FMU answers; that it ends the simulation at the stop time is no error."""
        try:
            return call()
        except EndedError as end:
            if end.reached < self._stop * (1.0 - SAME_TIME):
                raise
            return False

    def _forget(self) -> None:
        for part in self._fmus.values():
            part.forget()


def _with_exchange_states(system: System, equations: Mapping[str, FmuEquations]) -> System:
    """The system with the FMUs' continuous states for their states."""
    made = dict(system.instances)
    for name, fmu in equations.items():
        states = [Field(f"state[{i + 1}]", Quantity("", "continuous state"), 0.0) for i in range(fmu.states)]
        component = replace(made[name].component, state=NamedLayout(states))
        made[name] = replace(made[name], component=component, start={})
    return system.with_instances(made)


@dataclass(frozen=True)
class Solution:
    """All outputs (rows x outputs) at the times by the first method and by the second, and their names."""

    outputs: Vector
    others: Vector
    method_names: tuple[str, str]


def solve_equations(
    system: System,
    open_fmus: Open,
    linear: Transformations,
    times: Vector,
    stop: float,
    tolerance: float,
    progress: Callable[[float], None],
) -> Solution:
    """Solve the system at `times` by CVODE, and by DOP853 or Radau, each with fresh FMUs from times[0].

    `tolerance` is relative to nominal + |value|. ModelError or RunError where a method or an FMU fails.
    """
    sharp = max(SHARPER * tolerance, SHARPEST)
    rows, names = [], []
    for i, kind in enumerate((Cvode, RungeKutta)):
        equations = open_fmus()
        try:
            problem = PartwiseProblem(system, equations, linear)
            z = problem.start(float(times[0]), stop)
            stiff, longest = stiffness(problem, float(times[0]), z, times)
            method: Any = kind(problem, sharp, stiff, longest)
            found, _ = march(problem, method, z, float(times[0]), times, half(progress, i), problem.sample)
        finally:
            for fmu in equations.values():
                fmu.close()
        rows.append(found)
        names.append(method.name)
    return Solution(rows[0], rows[1], (names[0], names[1]))
