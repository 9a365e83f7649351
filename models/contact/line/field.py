"""The steps of a contact whose film is solved for: as many micro-steps of `transient` as its error asks.

A step takes the load from the approach of the bodies (or the approach from the load, in adherence form) and
gives the film. The field begins in the first step, from film_thickness: Hertz's pressure over a film of that
thickness.
"""

import math
from typing import Any

from ...compile.kernel import borrow, kernel, record_of
from ...core.component import Component
from ...core.integrator import NOT_CONVERGED, OK, copy, taylor
from ..fluid import build_lubricant
from .field_state import FOLLOWED, begin_state, build_bodies, next_scale, observe, read_drives, remember
from .heat_state import keep_heat, laws_of
from .jump_step import jump_step
from .transient import GAMMA, step
from .workspace import workspace_in, workspace_size

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
def swap(one: Any, other: Any) -> None:
    """Exchange the elements of two vectors."""
    for i in range(one.shape[0]):
        one[i], other[i] = other[i], one[i]


@kernel
def _slope(U: Any, s: float, j: int) -> float:
    """The rate of input j at s after the start."""
    return float(U[1, j] + s * (U[2, j] + s * U[3, j] / 2.0))


def field_work_size(states: int, inputs: int, nodes: int, layers: int = 0) -> int:
    """Elements of scratch that `advance` needs: copies of the state, inputs, fields, the solver's."""
    return 2 * states + inputs + FOLLOWED + 1 + 3 * nodes + workspace_size(nodes, layers)


def make_field_advance(component: Component) -> Any:
    """advance(t, h, x, U, p, scale, work) -> status, of a contact whose film is solved for.

    Samples (see `quadrature`) are taken at both stages of every micro-step, with the weights of the method.
    """
    nodes, layers, n = component.structure["nodes"], component.structure["layers"], component.state.size
    X, P = component.state.dtype, component.parameters.dtype
    INPUTS, m = component.inputs.dtype, component.inputs.size
    filled, followed = component.state.sizes["filled"], FOLLOWED + component.state.sizes["kept"]
    build_laws = laws_of(layers)
    solver, radius = workspace_size(nodes, layers), component.inputs.index("radius_of_curvature")
    sampled, sample = component.sample is not None, component.sample or _nothing

    @kernel
    def take_sample(
        t: float, s: float, length: float, result: Any, rate: float, x: Any, U: Any, u: Any, p: Any,
        laws: Any, w: Any, middle: Any, work: Any,
    ) -> None:  # fmt: skip
        """Of the first stage of a micro-step that began with x, s after the start."""
        at = s + GAMMA * length
        taylor(U, at, u)
        copy(middle, x)
        state, given, parameters = record_of(middle, X), record_of(u, INPUTS), record_of(p, P)
        state.grid_scale += GAMMA * (result.scale - state.grid_scale)
        state.rigid_approach = result.middle_approach
        state.approach_rate = rate
        state.curvature_rate = -_slope(U, at, radius) / given.radius_of_curvature**2
        copy(state.pressure, w.p_middle)
        copy(state.film, w.h_middle)
        copy(state.filling, w.filling_middle[:filled])
        swap(w.heat.stress, w.heat.stress_middle)
        observe(state, given, parameters, build_bodies(parameters), laws, w)
        swap(w.heat.stress, w.heat.stress_middle)
        sample((1.0 - GAMMA) * length, t, at, middle, U, u, p, work)

    @kernel
    def advance(t: float, h: float, x: Any, U: Any, p: Any, scale: Any, work: Any) -> int:
        parameters, work = record_of(p, P), borrow(work)
        start, u = work[0:n], work[n : n + m]
        # Vectors of their own: numba would compile the whole solver once more for those of a record.
        seen, rest = work[n + m : n + m + followed], work[n + m + followed :]
        pressure, film, slope = rest[:nodes], rest[nodes : 2 * nodes], rest[2 * nodes : 3 * nodes]
        w = workspace_in(rest[3 * nodes : 3 * nodes + solver], nodes, layers)
        if not h > 0.0:
            return OK
        copy(start, x)
        state, given = record_of(x, X), record_of(u, INPUTS)
        bodies, fluid = build_bodies(parameters), build_lubricant(parameters, parameters.density_law)
        laws = build_laws(parameters)
        taylor(U, 0.0, u)
        if state.grid_scale == 0.0:
            begin_state(state, given, parameters, laws, w)
            remember(state, 0.0, seen)
        s, micro, before = 0.0, h, math.inf
        for known in state.micro_step:
            micro = min(h, known) if known > 0.0 else h
        copy(pressure, state.pressure)
        copy(film, state.film)
        copy(slope, state.slope)
        copy(w.heat.flat, state.temperature)
        while s < h:
            # Not a small rest at the end: rates are differences over the last lengths.
            last = s + micro >= h
            length = h - s if last else min(micro, 0.5 * (h - s))
            copy(w.filling[:filled], state.filling)
            copy(w.heat.slope, state.temperature_slope)
            taylor(U, s, u)
            at_start = read_drives(given, parameters, state.rigid_approach, filled)
            taylor(U, s + 0.5 * length, u)
            new_scale = next_scale(state, given.radius_of_curvature, length, bodies)
            taylor(U, s + GAMMA * length, u)
            foretold = state.rigid_approach + GAMMA * length * state.approach_rate
            at_middle = read_drives(given, parameters, foretold, filled)
            taylor(U, s + length, u)
            at_end = read_drives(given, parameters, state.rigid_approach, filled)
            result = step(
                pressure, film, slope, state.grid_scale, new_scale, length,
                at_start, at_middle, at_end, parameters.field_tolerance, bodies, fluid, laws, w,
            )  # fmt: skip
            jumped_over = length <= JUMP_TIME and not result.error <= 1.0
            if jumped_over:
                result = jump_step(
                    pressure, film, slope, state.grid_scale, new_scale, length,
                    at_end, parameters.field_tolerance, bodies, fluid, laws, w,
                )  # fmt: skip
            shortest = length <= min(SMALLEST_SHARE * h, SMALLEST_STEP)
            jumped = jumped_over and (
                STAYS * before < result.error < math.inf
                or (shortest and result.error * parameters.field_tolerance <= JUMP_ERROR)
            )
            if result.error <= 1.0 or jumped:
                before = math.inf
                if jumped_over:
                    state.approach_rate = (result.approach - state.rigid_approach) / length
                else:
                    rate = (result.middle_approach - state.rigid_approach) / (GAMMA * length)
                    if sampled:
                        middle = rest[3 * nodes + solver : 3 * nodes + solver + n]
                        take_sample(t, s, length, result, rate, x, U, u, p, laws, w, middle, work)
                        taylor(U, s + length, u)
                    state.approach_rate = (result.approach - state.rigid_approach) / (GAMMA * length)
                    state.approach_rate -= (1.0 - GAMMA) / GAMMA * rate
                state.curvature_rate = -_slope(U, s + length, radius) / given.radius_of_curvature**2
                state.grid_scale, state.rigid_approach = result.scale, result.approach
                copy(state.pressure, pressure)
                copy(state.film, film)
                copy(state.filling, w.filling[:filled])
                keep_heat(state, 0.0 if jumped_over else length, GAMMA, w)
                observe(state, given, parameters, bodies, laws, w)
                if sampled:
                    sample(length if jumped_over else GAMMA * length, t, s + length, x, U, u, p, work)
                    taylor(U, s + length, u)
                s = h if last else s + length
                if jumped_over:
                    state.approach_rate = 0.0
                remember(state, 0.0 if jumped_over else length, seen)
                micro = length * min(3.0, _SAFETY * max(result.error, 1e-3) ** _POWER)
                continue
            before = result.error
            copy(pressure, w.p_start)
            copy(film, w.h_start)
            copy(slope, w.slope_start)
            copy(w.heat.flat, state.temperature)
            if shortest:
                copy(x, start)
                return NOT_CONVERGED
            micro = length * (max(0.2, _SAFETY * result.error**_POWER) if result.error < 1e300 else 0.5)
        copy(state.slope, slope)
        state.micro_step[:] = micro
        return OK

    return advance
