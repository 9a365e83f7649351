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
from typing import Any

import numpy as np

from ...compile.kernel import kernel, record_of
from ...core.component import Component
from ...core.implicit import ImplicitSteps
from ...core.integrator import NOT_CONVERGED, OK, copy, taylor
from ...core.quantities import Vector
from ...core.rates import make_rates
from ..films import FILMS
from ..fluid import lubricant_of
from ..mixed_lubrication import film_ratio
from .energies import grid_of, make_field_energy
from .field_state import (
    FOLLOWED,
    begin,
    bodies_of,
    carried_share,
    drives_of,
    fill_rates,
    next_scale,
    observe,
    remember,
    with_field_state,
)
from .grid import check_nodes
from .leap import leap
from .transient import GAMMA, step
from .workspace import workspace_in, workspace_size

LINE_TRANSIENT = float(list(FILMS).index("line_transient"))
# A step may be cut into so many times smaller ones before it is given up, a long one down to this time (s):
# a film that begins as no film would be needs 0.1 us at first, whatever the step.
SMALLEST_SHARE = 2.0**-16
SMALLEST_STEP = 1e-9
# A step that fails and is as short as this (s) is made by the implicit Euler method, right over a jump. One a
# fifth as long should have a twenty-fifth of the error: if it keeps this share, the error is of the jump, as
# is what is left of it in the shortest step, up to a share of load and film.
JUMP_TIME, STAYS, JUMP_ERROR = 1e-7, 0.5, 0.01
# Micro-steps grow and shrink with the error to this power (local error of order 3), aiming below it.
_POWER = -1.0 / 3.0
_SAFETY = 0.8


@kernel
def _nothing(weight: float, t: float, s: float, x: Any, U: Any, u: Any, p: Any, work: Any) -> None:
    return


@kernel
def _slope(U: Any, s: float, j: int) -> float:
    """The rate of input j at s after the start."""
    return float(U[1, j] + s * (U[2, j] + s * U[3, j] / 2.0))


def make_field_advance(component: FieldContact) -> Any:
    """advance(t, h, x, U, p, scale, work) -> status, of a contact whose film is solved for.

    Samples (see `quadrature`) are taken at both stages of every micro-step, with the weights of the method.
    """
    nodes, n = component.structure["nodes"], component.state.size
    X, P = component.state.dtype, component.parameters.dtype
    INPUTS, m = component.inputs.dtype, component.inputs.size
    solver, radius = workspace_size(nodes), component.inputs.index("radius_of_curvature")
    sampled, sample = component.sample is not None, component.sample or _nothing
    start_field = make_field_start(component)

    @kernel
    def take_sample(
        t: float, s: float, length: float, made: Any, rate: float, x: Any, U: Any, u: Any, p: Any, w: Any,
        middle: Any, work: Any,
    ) -> None:  # fmt: skip
        """Of the first stage of a micro-step that began with x, s after the start."""
        at = s + GAMMA * length
        taylor(U, at, u)
        copy(middle, x)
        state, given, parameters = record_of(middle, X), record_of(u, INPUTS), record_of(p, P)
        state.grid_scale += GAMMA * (made.scale - state.grid_scale)
        state.rigid_approach = made.middle_approach
        state.approach_rate = rate
        state.curvature_rate = -_slope(U, at, radius) / given.radius_of_curvature**2
        copy(state.pressure, w.p_middle)
        copy(state.film, w.h_middle)
        observe(state, given, parameters, bodies_of(parameters), w)
        sample((1.0 - GAMMA) * length, t, at, middle, U, u, p, work)

    @kernel
    def advance(t: float, h: float, x: Any, U: Any, p: Any, scale: Any, work: Any) -> int:
        parameters = record_of(p, P)
        start, u = work[0:n], work[n : n + m]
        # Vectors of their own: numba would compile the whole solver once more for those of a record.
        seen, rest = work[n + m : n + m + FOLLOWED], work[n + m + FOLLOWED :]
        pressure, film, slope = rest[:nodes], rest[nodes : 2 * nodes], rest[2 * nodes : 3 * nodes]
        w = workspace_in(rest[3 * nodes : 3 * nodes + solver], nodes)
        if not h > 0.0:
            return OK
        copy(start, x)
        state, given = record_of(x, X), record_of(u, INPUTS)
        bodies, fluid = bodies_of(parameters), lubricant_of(parameters)
        taylor(U, 0.0, u)
        start_field(x, U, p, work)
        s, micro, before = 0.0, h, math.inf
        copy(pressure, state.pressure)
        copy(film, state.film)
        copy(slope, state.slope)
        while s < h:
            # Not a small rest at the end: rates are differences over the last lengths.
            last = s + micro >= h
            length = h - s if last else min(micro, 0.5 * (h - s))
            taylor(U, s, u)
            at_start = drives_of(given, parameters, state.rigid_approach)
            taylor(U, s + 0.5 * length, u)
            new_scale = next_scale(state, given.radius_of_curvature, length, bodies)
            taylor(U, s + GAMMA * length, u)
            foretold = state.rigid_approach + GAMMA * length * state.approach_rate
            at_middle = drives_of(given, parameters, foretold)
            taylor(U, s + length, u)
            at_end = drives_of(given, parameters, state.rigid_approach)
            made = step(
                pressure, film, slope, state.grid_scale, new_scale, length,
                at_start, at_middle, at_end, parameters.field_tolerance, bodies, fluid, w,
            )  # fmt: skip
            leapt = length <= JUMP_TIME and not made.error <= 1.0
            if leapt:
                made = leap(
                    pressure, film, slope, state.grid_scale, new_scale, length,
                    at_end, parameters.field_tolerance, bodies, fluid, w,
                )  # fmt: skip
            shortest = length <= min(SMALLEST_SHARE * h, SMALLEST_STEP)
            jumped = leapt and (
                STAYS * before < made.error < math.inf
                or (shortest and made.error * parameters.field_tolerance <= JUMP_ERROR)
            )
            if made.error <= 1.0 or jumped:
                before = math.inf
                if leapt:
                    state.approach_rate = (made.approach - state.rigid_approach) / length
                else:
                    rate = (made.middle_approach - state.rigid_approach) / (GAMMA * length)
                    if sampled:
                        middle = rest[3 * nodes + solver : 3 * nodes + solver + n]
                        take_sample(t, s, length, made, rate, x, U, u, p, w, middle, work)
                        taylor(U, s + length, u)
                    state.approach_rate = (made.approach - state.rigid_approach) / (GAMMA * length)
                    state.approach_rate -= (1.0 - GAMMA) / GAMMA * rate
                state.curvature_rate = -_slope(U, s + length, radius) / given.radius_of_curvature**2
                state.grid_scale, state.rigid_approach = made.scale, made.approach
                copy(state.pressure, pressure)
                copy(state.film, film)
                observe(state, given, parameters, bodies, w)
                if sampled:
                    sample(length if leapt else GAMMA * length, t, s + length, x, U, u, p, work)
                    taylor(U, s + length, u)
                s = h if last else s + length
                if leapt:
                    state.approach_rate = 0.0
                remember(state, 0.0 if leapt else length, seen)
                micro = length * min(3.0, _SAFETY * max(made.error, 1e-3) ** _POWER)
                continue
            before = made.error
            copy(pressure, w.p_start)
            copy(film, w.h_start)
            copy(slope, w.slope_start)
            if shortest:
                copy(x, start)
                return NOT_CONVERGED
            micro = length * (max(0.2, _SAFETY * made.error**_POWER) if made.error < 1e300 else 0.5)
        copy(state.slope, slope)
        return OK

    return advance


def make_field_start(component: FieldContact) -> Any:
    """start(x, U, p, work): the field begins where it has not, as with the first step."""
    nodes, n, m = component.structure["nodes"], component.state.size, component.inputs.size
    X, P, INPUTS = component.state.dtype, component.parameters.dtype, component.inputs.dtype
    before = n + m + FOLLOWED + 3 * nodes
    after = before + workspace_size(nodes)

    @kernel
    def start(x: Any, U: Any, p: Any, work: Any) -> None:
        state, parameters, u = record_of(x, X), record_of(p, P), work[n : n + m]
        if state.grid_scale == 0.0:
            w = workspace_in(work[before:after], nodes)
            taylor(U, 0.0, u)
            given, bodies = record_of(u, INPUTS), bodies_of(parameters)
            begin(state, given, parameters, bodies, w.X)
            observe(state, given, parameters, bodies, w)
            remember(state, 0.0, work[n + m : n + m + FOLLOWED])

    return start


@dataclass(frozen=True, eq=False)
class FieldContact(Component):
    """`plain`, the contact of a formula, with a field: its kernels run on the first part of the state."""

    plain: Component = None  # type: ignore[assignment]  # given always, after fields with defaults

    @cached_property
    def flat_derivative(self) -> Any:
        """That of the formula, or the rates of what the field shows, once it has begun."""
        derivative, n = self.plain.flat_derivative, self.plain.state.size
        X, P = self.state.dtype, self.parameters.dtype

        @kernel
        def field_derivative(t: float, x: Any, u: Any, p: Any, dx: Any) -> None:
            for i in range(n, x.shape[0]):
                dx[i] = 0.0
            state = record_of(x, X)
            if record_of(p, P).film_model == LINE_TRANSIENT and state.grid_scale > 0.0:
                fill_rates(state, record_of(dx, X))
            else:
                derivative(t, x[:n], u, p, dx[:n])

        return field_derivative

    @cached_property
    def flat_output(self) -> Any:
        """Of the field, once it has begun."""
        output, n = self.plain.flat_output, self.plain.state.size
        X, P, Y = self.state.dtype, self.parameters.dtype, self.outputs.dtype
        INPUTS = self.inputs.dtype

        @kernel
        def field_output(t: float, x: Any, u: Any, p: Any, y: Any) -> None:
            output(t, x[:n], u, p, y)
            state, shown = record_of(x, X), record_of(y, Y)
            if record_of(p, P).film_model != LINE_TRANSIENT:
                return
            # Also of the film that the field will begin with, which is not thickened by a formula's sharing.
            shown.film_ratio = film_ratio(state.film_thickness, record_of(p, P).roughness)
            if state.grid_scale > 0.0:
                share = carried_share(record_of(u, INPUTS), record_of(p, P))
                shown.load = share * state.field_load
                shown.film_thickness = state.film_thickness
                shown.minimum_film_thickness = state.least_film
                shown.squeeze_velocity = state.film_rate
                shown.maximum_pressure = share * state.highest_pressure
                shown.asperity_load = share * state.field_asperity_load
                shown.viscous_friction = share * state.field_shear
                shown.boundary_friction = share * state.field_boundary_friction
                shown.friction_force = shown.viscous_friction + shown.boundary_friction
                shown.damping_margin = 1.0
                shown.separated = 1.0 if shown.load <= 0.0 else 0.0

        return field_output

    @cached_property
    def flat_energy(self) -> Any:
        """Of the field, also of the one that will begin."""
        energy, n, grid = self.plain.flat_energy, self.plain.state.size, grid_of(self.structure["nodes"])
        solved = make_field_energy(grid)
        X, U, P = self.state.dtype, self.inputs.dtype, self.parameters.dtype

        @kernel
        def begun(x: Any, u: Any, p: Any, e: Any) -> None:
            state, given, parameters = record_of(x, X), record_of(u, U), record_of(p, P)
            if state.grid_scale == 0.0:
                begin(state, given, parameters, bodies_of(parameters), grid)
                state.curvature = 1.0 / given.radius_of_curvature
            solved(state, given, parameters, e)

        @kernel
        def field_energy(t: float, x: Any, u: Any, p: Any, e: Any) -> None:
            if record_of(p, P).film_model == LINE_TRANSIENT:
                # A record does not keep the vector alive that it is of; an argument does.
                begun(x.copy(), u, p, e)
            else:
                energy(t, x[:n], u, p, e)

        return field_energy

    # What follows is not compiled, as the rest is: only what is asked for gets compiled, and a formula costs
    # what it does without a field.

    @cached_property
    def flat_rates(self) -> Any:
        """As `Component.flat_rates`."""
        n, plain, film_model = self.plain.state.size, self.plain, self.parameters.index("film_model")

        def flat_rates(
            t: float, x: Vector, u: Vector, du: Vector, p: Vector, work: Vector, yd: Vector
        ) -> None:
            if p[film_model] == LINE_TRANSIENT:
                self._field_rates(t, x, u, du, p, work, yd)
            else:
                plain.flat_rates(t, x[:n], u, du, p, work, yd)

        return flat_rates

    @cached_property
    def advance(self) -> Any:
        """As `Component.advance`."""
        n, plain, film_model = self.plain.state.size, self.plain, self.parameters.index("film_model")

        def advance(t: float, h: float, x: Vector, U: Vector, p: Vector, scale: Vector, work: Vector) -> int:
            if p[film_model] == LINE_TRANSIENT:
                return int(self.solving(t, h, x, U, p, scale, work))
            return int(plain.advance(t, h, x[:n], U, p, scale[:n], work))

        return advance

    @cached_property
    def step(self) -> Any:
        """As `Component.step`."""
        n, plain, film_model = self.plain.state.size, self.plain, self.parameters.index("film_model")

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
            if p[film_model] != LINE_TRANSIENT:
                return int(plain.step(t, h, x[:n], U, p, scale[:n], work, u, y))
            status = self.solving(t, h, x, U, p, scale, work)
            taylor(U, h, u)
            self.flat_output(t + h, x, u, p, y)
            return int(status)

        return step

    @cached_property
    def solving(self) -> Any:
        """`advance` as a kernel, of a film that is solved for."""
        return make_field_advance(self)

    @cached_property
    def _field_rates(self) -> Any:
        return make_rates(self.flat_derivative, self.flat_output, self.state, self.inputs, self.outputs)

    def nodes_of(self, work: Vector) -> Vector:
        """Where the nodes stand, in scales of the grid; from scratch in which a step has been made."""
        return np.asarray(workspace_in(work[self._scratch_before :], self.structure["nodes"]).X)

    @property
    def counting_class(self) -> Any:
        """See `counting_field`."""
        from .counting_field import CountingField  # it builds on this module

        return CountingField

    @cached_property
    def implicit(self) -> ImplicitSteps:
        """See `implicit_field`."""
        from .implicit import implicit_field  # it builds on this module

        return implicit_field(self)

    @property
    def work_size(self) -> int:
        """Copies of the state, the inputs, and the solver's scratch: more than the formula needs."""
        return self._scratch_before + workspace_size(self.structure["nodes"]) + self.state.size

    @property
    def _scratch_before(self) -> int:
        """Elements of scratch before the solver's workspace."""
        return self.state.size + self.inputs.size + FOLLOWED + 3 * self.structure["nodes"]


def with_field(plain: Component, nodes: int) -> FieldContact:
    """`plain`, an ehl_contact, with a field of so many nodes; ValueError for a number that cannot be."""
    check_nodes(nodes)
    attributes: dict[str, Any] = {f.name: getattr(plain, f.name) for f in fields(Component)}
    attributes |= {
        "state": with_field_state(plain.state, nodes),
        "structure": {"nodes": nodes},
        "requirements": (),
        "ode": False,
    }
    return FieldContact(**attributes, plain=plain)
