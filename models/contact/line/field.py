"""The lubricated contact with its film solved numerically in every step: a component with a pressure field.

It is the component `ehl_contact` with more evolving data: pressure and film over the nodes, the scale of
their grid and what outputs need. With film_model = line_transient its advance is that of `transient`: load
from the approach of the bodies (or approach from the load, in adherence form), film out. With any other
film model it moves as without a field.

It starts as the formula model does, from film_thickness: Hertz's pressure over a film of that thickness.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Annotated, Any

import numpy as np

from ...component import Component
from ...implicit import ImplicitSteps
from ...integrator import NOT_CONVERGED, OK, copy, taylor
from ...kernel import kernel, record_of
from ...quantities import Layout, Quantity, Vector, per_element
from ..films import FILMS
from ..fluid import lubricant_of
from ..friction import profile_friction
from ..hertz import compliance_of, deflection, load_of
from ..mixed_lubrication import surfaces_of, traction_of
from .newton import Bodies, line_load_of
from .reynolds import Flow
from .transient import GAMMA, Drives, central, grid_scale_after, least, place_film, step, wanted_scale
from .workspace import Workspace, workspace_in, workspace_size

LINE_TRANSIENT = float(list(FILMS).index("line_transient"))
# Fewer do not resolve the contact, whatever its conditions.
FEWEST_NODES = 51
# Outputs that steps of the field give.
_OF_THE_FIELD = (
    "load", "film_thickness", "minimum_film_thickness", "squeeze_velocity", "maximum_pressure",
)  # fmt: skip
# A step may be cut into so many times smaller ones before it is given up.
SMALLEST_SHARE = 2.0**-16
# A step a fifth as long should have a hundredth of the error; if it keeps this share, that is of a jump.
STAYS = 0.5
# Micro-steps grow and shrink with the error to this power (local error of order 3), aiming below it.
_POWER = -1.0 / 3.0
_SAFETY = 0.8


def _extended(plain: Layout, nodes: int) -> Layout:
    """The state of the contact, then the field."""

    @dataclass
    class FieldState(plain.record):  # type: ignore[name-defined, misc]
        field_load: Annotated[float, Quantity("N", "load of the pressure field", internal=True)] = 0.0
        least_film: Annotated[float, Quantity("m", "smallest film", internal=True)] = 0.0
        highest_pressure: Annotated[float, Quantity("Pa", "largest pressure", internal=True)] = 0.0
        film_rate: Annotated[float, Quantity("m/s", "rate of the central film", internal=True)] = 0.0
        elastic_energy: Annotated[float, Quantity("J", "energy of deflection", internal=True)] = 0.0
        film_power: Annotated[
            float, Quantity("W", "power of the film on the surfaces, mean of the last step", internal=True)
        ] = 0.0
        field_asperity_load: Annotated[float, Quantity("N", "load on asperities", internal=True)] = 0.0
        field_shear: Annotated[float, Quantity("N", "shear of the film", internal=True)] = 0.0
        field_boundary_friction: Annotated[float, Quantity("N", "friction of asperities", internal=True)] = (
            0.0
        )
        rigid_approach: Annotated[float, Quantity("m", "approach of the bodies", internal=True)] = 0.0
        grid_scale: Annotated[float, Quantity("m", "scale of the grid; 0: not begun", internal=True)] = 0.0
        pressure: Annotated[
            Any, Quantity("Pa", "pressure over the nodes", nominal=1e8, internal=True, size="nodes")
        ] = per_element()
        film: Annotated[
            Any, Quantity("m", "film over the nodes", nominal=1e-6, internal=True, size="nodes")
        ] = per_element()
        slope: Annotated[
            Any,
            Quantity("Pa/s", "rate of pressure in the last step", nominal=1e12, internal=True, size="nodes"),
        ] = per_element()

    return Layout(FieldState, {**plain.sizes, "nodes": nodes})


@kernel
def bodies_of(p: Any) -> Bodies:
    """The elastic pair that the parameters describe."""
    compliance = compliance_of(p)
    return Bodies(compliance, p.length)


@kernel
def drives_of(u: Any, p: Any, approach: float) -> Drives:
    """What the inputs ask for; `approach` is the guess where the load is given.

    A load is at least film_load_floor: without any, the bodies would part at once, however far.
    """
    flow = Flow(u.entraining_velocity, u.sliding_velocity, u.radius_of_curvature)
    if p.load_is_given != 0.0:
        return Drives(flow, approach, max(u.applied_load, p.film_load_floor) / p.length)
    return Drives(flow, u.approach - u.retreat, -1.0)


@kernel
def deflection_energy(x: Any, radius: float, bodies: Bodies, w: Workspace) -> float:
    """Half the integral of pressure times deflection (J)."""
    total = 0.0
    for i in range(x.pressure.shape[0]):
        deflected = x.film[i] + x.rigid_approach - (x.grid_scale * w.X[i]) ** 2 / (2.0 * radius)
        total += w.weight[i] * x.pressure[i] * deflected
    return 0.5 * total * x.grid_scale * bodies.length


@kernel
def observe(x: Any, radius: float, bodies: Bodies, w: Workspace) -> None:
    """The numbers that outputs need, from pressure and film."""
    x.elastic_energy = deflection_energy(x, radius, bodies, w)
    x.field_load = line_load_of(x.pressure, w.weight, x.grid_scale) * bodies.length
    x.film_thickness = central(x.film)
    x.least_film = least(x.film)
    x.highest_pressure = 0.0
    for i in range(x.pressure.shape[0]):
        x.highest_pressure = max(x.highest_pressure, x.pressure[i])


@kernel
def rub(x: Any, u: Any, p: Any, bodies: Bodies, w: Workspace) -> None:
    """Load and friction of the asperities under the film, and its shear."""
    found = profile_friction(
        w.X, x.pressure, x.film, x.grid_scale * bodies.length, u.sliding_velocity, bodies.compliance,
        lubricant_of(p), surfaces_of(p), traction_of(p),
    )  # fmt: skip
    x.field_asperity_load = found.asperity_load
    x.field_shear = found.viscous
    x.field_boundary_friction = found.boundary


@kernel
def begin(x: Any, u: Any, p: Any, bodies: Bodies, X: Any) -> None:
    """Hertz's pressure over a film of film_thickness."""
    film, radius = x.film_thickness, u.radius_of_curvature
    if p.load_is_given != 0.0:
        load = max(u.applied_load, p.film_load_floor)
        x.rigid_approach = deflection(load, radius, bodies.length, bodies.compliance) - film
        gap = film
    else:
        x.rigid_approach = u.approach - u.retreat
        load = load_of(x.rigid_approach + film, radius, bodies.length, bodies.compliance)
        gap = film if load > 0.0 else -x.rigid_approach
    x.grid_scale = wanted_scale(load / bodies.length, gap, radius, bodies)
    place_film(load, gap, radius, bodies, X, x.grid_scale, x.pressure, x.film)


def make_field_advance(component: FieldContact) -> Any:
    """advance(t, h, x, U, p, scale, work) -> status, of a contact whose film is solved for."""
    nodes, n = component.structure["nodes"], component.state.size
    X, P = component.state.dtype, component.parameters.dtype
    INPUTS, m = component.inputs.dtype, component.inputs.size

    @kernel
    def advance(t: float, h: float, x: Any, U: Any, p: Any, scale: Any, work: Any) -> int:
        parameters = record_of(p, P)
        start, u = work[0:n], work[n : n + m]
        # Vectors of their own: numba would compile the whole solver once more for those of a record.
        rest = work[n + m :]
        pressure, film, slope = rest[:nodes], rest[nodes : 2 * nodes], rest[2 * nodes : 3 * nodes]
        w = workspace_in(rest[3 * nodes :], nodes)
        copy(start, x)
        state, given = record_of(x, X), record_of(u, INPUTS)
        bodies, fluid = bodies_of(parameters), lubricant_of(parameters)
        taylor(U, 0.0, u)
        if state.grid_scale == 0.0:
            begin(state, given, parameters, bodies, w.X)
            observe(state, given.radius_of_curvature, bodies, w)
        s, micro, before = 0.0, h, math.inf
        copy(pressure, state.pressure)
        copy(film, state.film)
        copy(slope, state.slope)
        central_film, load, stored = state.film_thickness, state.field_load, state.elastic_energy
        approach = state.rigid_approach if parameters.load_is_given != 0.0 else given.approach - given.retreat
        while s < h:
            last = s + micro >= h
            length = h - s if last else micro
            taylor(U, s, u)
            at_start = drives_of(given, parameters, state.rigid_approach)
            new_scale = grid_scale_after(length, state.grid_scale, pressure, film, at_start, bodies, w)
            taylor(U, s + GAMMA * length, u)
            at_middle = drives_of(given, parameters, state.rigid_approach)
            taylor(U, s + length, u)
            at_end = drives_of(given, parameters, state.rigid_approach)
            made = step(
                pressure, film, slope, state.grid_scale, new_scale, length,
                at_start, at_middle, at_end, parameters.field_tolerance, bodies, fluid, w,
            )  # fmt: skip
            # An error that stays as steps get shorter is that of a jump, which no step resolves.
            if made.error <= 1.0 or STAYS * before < made.error < math.inf:
                before = math.inf
                s = h if last else s + length
                state.grid_scale, state.rigid_approach = made.scale, made.approach
                micro = length * min(3.0, _SAFETY * max(made.error, 1e-3) ** _POWER)
                continue
            before = made.error
            copy(pressure, w.p_start)
            copy(film, w.h_start)
            copy(slope, w.slope_start)
            if length <= SMALLEST_SHARE * h:
                copy(x, start)
                return NOT_CONVERGED
            micro = length * (max(0.2, _SAFETY * made.error**_POWER) if made.error < 1e300 else 0.5)
        copy(state.pressure, pressure)
        copy(state.film, film)
        copy(state.slope, slope)
        observe(state, given.radius_of_curvature, bodies, w)
        rub(state, given, parameters, bodies, w)
        if h > 0.0:
            state.film_rate = (state.film_thickness - central_film) / h
            work_in = 0.5 * (state.field_load + load) * (state.rigid_approach - approach)
            state.film_power = (state.elastic_energy - stored - work_in) / h
        return OK

    return advance


@dataclass(frozen=True, eq=False)
class FieldContact(Component):
    """`plain`, the contact of a formula, with a field: its kernels run on the first part of the state."""

    plain: Component = None  # type: ignore[assignment]  # given always, after fields with defaults

    @cached_property
    def flat_derivative(self) -> Any:
        """That of the formula; the field changes with steps."""
        derivative, n = self.plain.flat_derivative, self.plain.state.size

        @kernel
        def field_derivative(t: float, x: Any, u: Any, p: Any, dx: Any) -> None:
            derivative(t, x[:n], u, p, dx[:n])
            for i in range(n, x.shape[0]):
                dx[i] = 0.0

        return field_derivative

    @cached_property
    def flat_output(self) -> Any:
        """Of the field, once it has begun."""
        output, n = self.plain.flat_output, self.plain.state.size
        X, P, Y = self.state.dtype, self.parameters.dtype, self.outputs.dtype

        @kernel
        def field_output(t: float, x: Any, u: Any, p: Any, y: Any) -> None:
            output(t, x[:n], u, p, y)
            state, shown = record_of(x, X), record_of(y, Y)
            if record_of(p, P).film_model == LINE_TRANSIENT and state.grid_scale > 0.0:
                shown.load = state.field_load
                shown.film_thickness = state.film_thickness
                shown.minimum_film_thickness = state.least_film
                shown.squeeze_velocity = state.film_rate
                shown.maximum_pressure = state.highest_pressure
                shown.asperity_load = state.field_asperity_load
                shown.film_ratio = state.film_thickness / record_of(p, P).roughness
                shown.viscous_friction = state.field_shear
                shown.boundary_friction = state.field_boundary_friction
                shown.friction_force = state.field_shear + state.field_boundary_friction
                shown.damping_margin = 1.0
                shown.separated = 1.0 if state.field_load <= 0.0 else 0.0

        return field_output

    @cached_property
    def flat_energy(self) -> Any:
        """Of the field, once it has begun."""
        energy, n = self.plain.flat_energy, self.plain.state.size
        X, P = self.state.dtype, self.parameters.dtype

        @kernel
        def field_energy(t: float, x: Any, u: Any, p: Any, e: Any) -> None:
            energy(t, x[:n], u, p, e)
            state = record_of(x, X)
            if record_of(p, P).film_model == LINE_TRANSIENT and state.grid_scale > 0.0:
                e[0], e[1], e[2] = state.elastic_energy, 0.0, state.film_power

        return field_energy

    @cached_property
    def _solving(self) -> Any:
        return make_field_advance(self)

    @cached_property
    def advance(self) -> Any:
        """As `Component.advance`, but not compiled: only the one that is asked for gets compiled."""
        plain, n = self.plain, self.plain.state.size
        film_model = self.parameters.index("film_model")

        def advance(t: float, h: float, x: Vector, U: Vector, p: Vector, scale: Vector, work: Vector) -> int:
            if p[film_model] == LINE_TRANSIENT:
                return int(self._solving(t, h, x, U, p, scale, work))
            return int(plain.advance(t, h, x[:n], U, p, scale[:n], work))

        return advance

    @cached_property
    def step(self) -> Any:
        """As `Component.step`, but not compiled."""
        advance, output = self.advance, self.flat_output

        def step(
            t: float,
            h: float,
            x: Vector,
            U: Vector,
            p: Vector,
            scale: Vector,
            work: Vector,
            u: Vector,
            y: Vector,
        ) -> int:
            status = advance(t, h, x, U, p, scale, work)
            taylor(U, h, u)
            output(t + h, x, u, p, y)
            return int(status)

        return step

    def nodes_of(self, work: Vector) -> Vector:
        """Where the nodes stand, in scales of the grid; from scratch in which a step has been made."""
        return np.asarray(workspace_in(work[self._scratch_before :], self.structure["nodes"]).X)

    @cached_property
    def implicit(self) -> ImplicitSteps:
        """See `implicit_field`."""
        from .implicit import implicit_field  # it builds on this module

        return implicit_field(self)

    @property
    def work_size(self) -> int:
        """A copy of the state and the inputs, and the solver's scratch: more than the formula needs."""
        return self._scratch_before + workspace_size(self.structure["nodes"])

    @property
    def _scratch_before(self) -> int:
        """Elements of scratch before the solver's workspace."""
        return self.state.size + self.inputs.size + 3 * self.structure["nodes"]


def with_field(plain: Component, nodes: int) -> FieldContact:
    """`plain`, an ehl_contact, with a field of so many nodes; ValueError for a number that cannot be."""
    if nodes < FEWEST_NODES or nodes % 2 == 0:
        raise ValueError(f"nodes = {nodes}: must be odd and >= {FEWEST_NODES}, or 0 for no pressure field")
    attributes: dict[str, Any] = {f.name: getattr(plain, f.name) for f in fields(Component)}
    attributes |= {
        "state": _extended(plain.state, nodes),
        "structure": {"nodes": nodes},
        "check": lambda parameters: (),
        # The field is no ODE, its steps take no samples of powers, and what they give has no rate.
        "ode": False,
        "samples": False,
        "unrated": _OF_THE_FIELD,
    }
    return FieldContact(**attributes, plain=plain)
