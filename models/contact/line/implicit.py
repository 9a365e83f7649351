"""The pressure field solved together with all that surrounds it: see `ImplicitSteps`.

Carried are the masses of the volumes, the grid's scale, which follows the contact as
d(scale)/dt = (wanted scale - scale)/GRID_TIME (the law that `transient` takes step by step), and, for rates,
central film, curvature and approach.
"""

from typing import Any

from ...compile.kernel import kernel, record_of
from ...core.implicit import ImplicitSteps
from ...core.integrator import NOT_CONVERGED, OK, copy
from ..fluid import build_lubricant
from .cavities import fill_partly
from .field_state import begin_state, build_bodies, observe, read_drives
from .mixed import fill_total
from .newton import FilmProblem, forget_factors, integrate_pressure, newton
from .reynolds import properties
from .transient import GRID_TIME, aimed_scale, central, end_filling, masses
from .workspace import workspace_in, workspace_size

# Behind the masses.
_SCALE, _FILM, _CURVATURE, _APPROACH = range(4)


def implicit_field(component: Any) -> ImplicitSteps:
    """Implicit steps of an ehl_line_contact."""
    nodes = component.structure["nodes"]
    filled = component.state.sizes["filled"]
    solver = workspace_size(nodes)
    X, U, P = component.state.dtype, component.inputs.dtype, component.parameters.dtype

    @kernel
    def start(x: Any, u: Any, p: Any, work: Any) -> None:
        state, given, constants = record_of(x, X), record_of(u, U), record_of(p, P)
        w = workspace_in(work, nodes)
        forget_factors(w)
        if state.grid_scale == 0.0:
            begin_state(state, given, constants, w)

    @kernel
    def carry(x: Any, u: Any, p: Any, work: Any, q: Any) -> None:
        state, constants = record_of(x, X), record_of(p, P)
        w = workspace_in(work, nodes)
        properties(state.pressure, state.film, build_lubricant(constants, constants.density_law), w.nodes)
        if filled:
            fill_partly(state.pressure, state.filling, w.nodes)
        masses(state.grid_scale, w, q[:nodes])
        rest = q[nodes:]
        rest[_SCALE], rest[_FILM] = state.grid_scale, state.film_thickness
        rest[_CURVATURE], rest[_APPROACH] = state.curvature, state.rigid_approach

    @kernel
    def stage(x: Any, u: Any, p: Any, base: Any, interval: float, work: Any) -> int:
        state, given, constants = record_of(x, X), record_of(u, U), record_of(p, P)
        w = workspace_in(work, nodes)
        # Vectors of their own, as in `make_field_advance`: those of a record would compile the solver again.
        pressure, film = work[solver : solver + nodes], work[solver + nodes : solver + 2 * nodes]
        copy(pressure, state.pressure)
        copy(film, state.film)
        bodies, fluid = build_bodies(constants), build_lubricant(constants, constants.density_law)
        before = base[nodes:]
        drives = read_drives(given, constants, state.rigid_approach, filled)
        fill_total(pressure, film, bodies, w.mixed.total)
        load = integrate_pressure(w.mixed.total, w.weight, state.grid_scale)
        wanted = aimed_scale(state.grid_scale, load, central(film), drives.flow.radius, bodies)
        share = interval / GRID_TIME
        scale = (before[_SCALE] + share * wanted) / (1.0 + share)
        rate = (scale - before[_SCALE]) / interval
        problem = FilmProblem(scale, rate, drives.flow, drives.line_load, interval)
        found = newton(pressure, film, drives.approach, problem, bodies, fluid, base[:nodes], w)
        copy(state.pressure, pressure)
        copy(state.film, film)
        if found.error != 0.0:
            return NOT_CONVERGED
        if filled:
            end_filling(pressure, film, scale, interval, drives.flow, w)
            copy(state.filling, w.filling)
        state.grid_scale, state.rigid_approach = scale, found.approach
        observe(state, given, constants, bodies, w)
        state.film_rate = (state.film_thickness - before[_FILM]) / interval
        state.curvature_rate = (state.curvature - before[_CURVATURE]) / interval
        state.approach_rate = (found.approach - before[_APPROACH]) / interval
        return OK

    return ImplicitSteps(nodes + 4, solver + 2 * nodes, start, carry, stage)
