"""A component: the types and kernels of one subsystem, and everything its adapters need.

One definition serves in-process runs, FMUs, the monolithic reference and studies: they all call the
flat kernels made here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..compile.kernel import kernel, record_of
from .hybrid import GUARD_WORK_SIZE, HybridMotion, make_hybrid_advance
from .implicit import ImplicitSteps
from .integrator import TOLERANCE, make_advance, taylor, work_size
from .quantities import INPUT_COEFFICIENTS, Layout, Vector
from .rates import input_rates, make_rates, rates_work_size
from .requirements import Requirement
from .roles import Role, SomeRole

# Indices of what an energy kernel writes, in J, W and W.
STORED, DISSIPATED_POWER, SOURCE_POWER = 0, 1, 2

# States of components with impacts: energy (J) that impacts have lost, and that their impulses have given.
IMPACT_LOSS, IMPACT_WORK = "impact_loss", "impact_work"

# The value of an output `next_event` (s) where no event is known.
NO_EVENT = 1e30


# Of one structural size. The description of an FMU lists which force depends on which displacement: with 500
# coil masses it has 15 MB and takes seconds to write, with 5000 minutes.
MOST_ELEMENTS = 500


def check_sizes(**sizes: int) -> None:
    """ValueError for a number of elements out of range."""
    for name, size in sizes.items():
        if not 1 <= size <= MOST_ELEMENTS:
            raise ValueError(
                f"{name} = {size}: must be from 1 to {MOST_ELEMENTS} (variables and their dependencies grow "
                "with its square)"
            )


@dataclass(frozen=True)
class PowerBond:
    """Power into the component is sign * (variable `effort`) * (variable `flow`).

    Each variable is an input or an output of the component.
    """

    effort: str
    flow: str
    sign: int


@dataclass(frozen=True)
class Events:
    """What a component with impacts or changes of mode adds to its derivative.

    guards(t, x, u, p, g): an event happens where an element of g falls from >= 0 to below zero.
    transition(k, t, x, u, p): changes the record x when guard k has fallen (impact map, change of mode);
    afterwards guard k must not be negative.
    """

    count: int
    guards: Any
    transition: Any


@dataclass(frozen=True)
class Flat:
    """The kernels of a component on float vectors in the place of records; guards and transition are None
    without events."""

    derivative: Any  # (t, x, u, p, dx)
    output: Any  # (t, x, u, p, y)
    energy: Any  # (t, x, u, p, e); e has three elements
    guards: Any = None  # (t, x, u, p, g)
    transition: Any = None  # (k, t, x, u, p), which changes x


@dataclass(frozen=True, eq=False)
class Component:
    """One subsystem.

    Kernels take records: derivative(t, x, u, p, dx), output(t, x, u, p, y), energy(t, x, u, p, e) with
    e = [stored energy (J), dissipated power (W), power of internal sources (W)].
    `feedthrough` lists, for each output, the inputs it depends on at the same instant.
    `requirements` relate parameters to each other. `start_requirements` relate start states to parameters and
    inputs; their messages begin with the state's name.

    `advance_maker(component)` returns an advance kernel that replaces the standard integrator (with events:
    the hybrid one). It has `extra_work` elements of scratch after those of the integrator. With h = 0 it
    leaves the state unchanged, and it calls `sample` where that is given (see `quadrature`).
    `implicit_maker(component)` returns the implicit steps of a component whose motion is not dx/dt =
    derivative, such as a pressure field that only `advance` finds. Its derivative serves rates of outputs and
    equilibria only. Solvers of ODEs refuse it; the monolithic reference takes the implicit steps.
    `opaque`: the equations are unknown, as of an FMU of another tool.
    `resting`: the states that stand still in an equilibrium of the system. None: all. (): none, as for
    a crank, which turns while the mechanisms that it drives are at rest.

    `roles` say what it is in a mechanism; their outputs must exist. The four fields before name outputs that
    masters use (ValueError for other names). `event_indicators` are
    continuous and change their sign where the mode changes (contact made or lost). `event_counter` counts
    events inside the component (impacts, landings, releases). `event_time` is the time (s) of the last one.
    `next_event` is the time (s) of the next known event ahead, at which an input or a profile loses
    smoothness, or NO_EVENT.
    """

    name: str
    description: str
    parameters: Layout
    state: Layout
    inputs: Layout
    outputs: Layout
    derivative: Any
    output: Any
    energy: Any
    feedthrough: Mapping[str, Sequence[str]]
    bonds: Sequence[PowerBond] = ()
    events: Events | None = None
    requirements: Sequence[Requirement] = ()
    start_requirements: Sequence[Requirement] = ()
    advance_maker: Callable[[Component], Any] | None = None
    extra_work: int = 0
    implicit_maker: Callable[[Component], ImplicitSteps] | None = None
    opaque: bool = False
    sample: Any = None
    structure: Mapping[str, int] = field(default_factory=dict)
    resting: Sequence[str] | None = None
    tolerance: float = TOLERANCE
    event_indicators: Sequence[str] = ()
    event_counter: str = ""
    event_time: str = ""
    next_event: str = ""
    roles: Sequence[Role] = ()

    def __post_init__(self) -> None:
        for layout in (self.parameters, self.inputs, self.outputs):
            if len(layout.variables) < layout.size:
                name = next(name for name in layout.names if name not in layout.variables)
                raise ValueError(f"{self.name}: {name} must not be internal: only states may be")
        inputs, outputs = self.inputs.names, self.outputs.names
        named = [*self.event_indicators, self.event_counter, self.event_time, self.next_event]
        named += [name for role in self.roles for name in role.promised]
        for name, kind, known in (
            *((name, "output {}, for events or a role,", outputs) for name in named if name),
            *((name, "output {} of feedthrough", outputs) for name in self.feedthrough),
            *((name, "input {} of feedthrough", inputs) for of in self.feedthrough.values() for name in of),
            *(
                (name, "variable {} of a bond", (*inputs, *outputs))
                for one in self.bonds
                for name in (one.effort, one.flow)
            ),
        ):
            if name not in known:
                raise ValueError(f"{self.name}: {kind.format(repr(name))} must be one of {', '.join(known)}")

    def find_role(self, kind: type[SomeRole]) -> SomeRole | None:
        """Its role of this kind; None if it has none."""
        return next((role for role in self.roles if isinstance(role, kind)), None)

    def has_role(self, *kinds: type[Role]) -> bool:
        """Whether it has a role of one of these kinds."""
        return any(isinstance(role, kinds) for role in self.roles)

    @cached_property
    def flat(self) -> Flat:
        """Its kernels on float vectors."""
        X, U, P = self.state.dtype, self.inputs.dtype, self.parameters.dtype

        def write_record(function: Any, R: Any) -> Any:
            @kernel
            def flat(t: float, x: Any, u: Any, p: Any, out: Any) -> None:
                function(t, record_of(x, X), record_of(u, U), record_of(p, P), record_of(out, R))

            return flat

        def write_vector(function: Any) -> Any:
            @kernel
            def flat(t: float, x: Any, u: Any, p: Any, out: Any) -> None:
                function(t, record_of(x, X), record_of(u, U), record_of(p, P), out)

            return flat

        kernels = Flat(
            write_record(self.derivative, X),
            write_record(self.output, self.outputs.dtype),
            write_vector(self.energy),
        )
        if self.events is None:
            return kernels
        change = self.events.transition

        @kernel
        def flat_transition(k: int, t: float, x: Any, u: Any, p: Any) -> None:
            change(k, t, record_of(x, X), record_of(u, U), record_of(p, P))

        return replace(kernels, guards=write_vector(self.events.guards), transition=flat_transition)

    flat_derivative = property(lambda self: self.flat.derivative)
    flat_output = property(lambda self: self.flat.output)
    flat_energy = property(lambda self: self.flat.energy)
    flat_guards = property(lambda self: self.flat.guards)
    flat_transition = property(lambda self: self.flat.transition)

    @cached_property
    def flat_rates(self) -> Any:
        """(t, x, u, du, p, work, yd) on float vectors: time derivatives of the outputs; see `rates`.

        du: time derivatives of the inputs; work has `rates_work_size` elements.
        """
        return make_rates(self.flat_derivative, self.flat_output, self.state, self.inputs, self.outputs)

    @property
    def input_rates(self) -> Any:
        """(U, s, du): slopes of the inputs' polynomials at s after the start."""
        return input_rates

    @property
    def motion(self) -> HybridMotion:
        """What is integrated across events."""
        return HybridMotion(
            self.flat_derivative, self.flat_guards, self.flat_transition, self.sample, self.state.size,
            self.inputs.size, self.events.count if self.events else 0, self.tolerance,
        )  # fmt: skip

    @cached_property
    def advance(self) -> Any:
        """advance(t, h, x, U, p, scale, work) -> status: moves x in place over [t, t + h] with the inputs'
        polynomials U; unchanged if the status is not OK."""
        if self.advance_maker:
            return self.advance_maker(self)
        if self.events:
            return make_hybrid_advance(self.motion)
        return make_advance(self.flat_derivative, self.state, self.inputs, self.sample, self.tolerance)

    @cached_property
    def implicit(self) -> ImplicitSteps | None:
        """Implicit steps of a component that is no ODE, for the monolithic reference; None: it has none."""
        return self.implicit_maker(self) if self.implicit_maker else None

    @property
    def ode(self) -> bool:
        """Whether dx/dt = derivative describes the motion."""
        return not self.opaque and self.implicit_maker is None

    @cached_property
    def step(self) -> Any:
        """step(t, h, x, U, p, scale, work, u, y) -> status.

        Advances x in place over [t, t + h] with the inputs' polynomials U, then leaves the inputs and
        outputs at the end in u and y. x is unchanged if the status is not OK.
        """
        advance, output = self.advance, self.flat_output

        @kernel
        def step(t: float, h: float, x: Any, U: Any, p: Any, scale: Any, work: Any, u: Any, y: Any) -> int:
            status = advance(t, h, x, U, p, scale, work)
            taylor(U, h, u)
            output(t + h, x, u, p, y)
            return status

        return step

    @property
    def standard_work_size(self) -> int:
        """Length of the scratch vector for an advance that is integrated."""
        return work_size(self.state, self.inputs) + GUARD_WORK_SIZE * self.motion.guard_count

    @property
    def work_size(self) -> int:
        """Length of the scratch vector for `step`."""
        return self.standard_work_size + self.extra_work

    @property
    def rates_work_size(self) -> int:
        """Length of the scratch vector for `flat_rates`."""
        return rates_work_size(self.state, self.inputs, self.outputs)

    def parameter_faults(self, p: Vector) -> list[str]:
        """Messages for parameters outside their ranges, alone or together."""
        return self.parameters.faults(p) or _unmet(self.requirements, self.parameters.view(p))

    @property
    def kernel_state(self) -> Layout:
        """The states that the record kernels are written for; `state` may have others after them."""
        return self.state

    def start_faults(self, p: Vector, x: Vector, u: Vector) -> list[str]:
        """Messages for start states outside their ranges, or that do not fit parameters and inputs."""
        own = self.kernel_state.view(x[: self.kernel_state.size])
        records = own, self.inputs.view(u), self.parameters.view(p)
        return self.state.faults(x) or _unmet(self.start_requirements, *records)

    def input_faults(self, U: Vector, h: float) -> list[str]:
        """Messages for inputs outside their ranges at the start or the end of a step."""
        u = np.zeros(self.inputs.size)
        found: dict[str, None] = {}
        for s in (0.0, h):
            taylor(U, s, u)
            found |= dict.fromkeys(self.inputs.faults(u))
        return list(found)

    def input_polynomial(self) -> Vector:
        """Taylor coefficients for `step`: row 0 the start values, the rest zero."""
        U = np.zeros((INPUT_COEFFICIENTS, self.inputs.size))
        U[0] = self.inputs.start
        return U


def _unmet(requirements: Sequence[Requirement], *records: Any) -> list[str]:
    return [fault for requirement in requirements if (fault := requirement.fault(*records))]
