"""The pressure field solved together with all that surrounds it: see `ImplicitSteps`.

Carried are the masses of the volumes, the grid's scale, which follows the contact as
d(scale)/dt = (wanted scale - scale)/GRID_TIME (the law that `transient` takes step by step), and, for rates,
central film, curvature and approach. A heated film carries its heat, and for rates its pressure and both
largest rises.
"""

from typing import Any

from ...compile.kernel import borrow, kernel, record_of, shaped
from ...core.implicit import ImplicitSteps
from ...core.integrator import NOT_CONVERGED, OK, copy, copy_rows
from ..fluid import build_lubricant
from .cavities import fill_partly
from .field_state import begin_state, build_bodies, observe, read_drives
from .heat import store
from .heat_state import keep_heat, laws_of
from .heated import begin_heat, solve_film
from .mixed import fill_total
from .newton import FilmProblem, forget_factors, integrate_pressure
from .reynolds import properties
from .shear import HeatLaws
from .transient import GRID_TIME, aimed_scale, central, end_filling, masses
from .workspace import Workspace, rows_of, workspace_in, workspace_size

# Behind the masses.
_SCALE, _FILM, _CURVATURE, _APPROACH = range(4)
_FILM_RISE, _SURFACE_RISE, _HOT = 4, 5, 6


@kernel
def carry_heat(x: Any, pressure: Any, mass: Any, rest: Any, laws: HeatLaws, w: Workspace) -> None:
    """Behind the rates' values: largest rises, pressure and heat."""
    n = pressure.shape[0]
    rest[_FILM_RISE], rest[_SURFACE_RISE] = x.film_rise, x.surface_rise
    copy(rest[_HOT : _HOT + n], pressure)
    store(w.X, x.grid_scale, mass, w.heat.rise, 1.0, laws, shaped(rest[_HOT + n :], w.heat.rise.shape))


@kernel
def take_heat(x: Any, before: Any, w: Workspace) -> None:
    """A stage begins with the state's temperatures as guess, and with what `carry_heat` wrote as base."""
    n = w.X.shape[0]
    copy(w.heat.flat, x.temperature)
    copy(w.heat.slope, x.temperature)
    copy(w.heat.pressure_base, before[_HOT : _HOT + n])
    copy_rows(w.heat.base, shaped(before[_HOT + n :], w.heat.base.shape))
    x.film_rise, x.surface_rise = before[_FILM_RISE], before[_SURFACE_RISE]


def implicit_field(component: Any) -> ImplicitSteps:
    """Implicit steps of an ehl_line_contact."""
    nodes, layers = component.structure["nodes"], component.structure["layers"]
    filled, build_laws = component.state.sizes["filled"], laws_of(layers)
    solver = workspace_size(nodes, layers)
    X, U, P = component.state.dtype, component.inputs.dtype, component.parameters.dtype

    @kernel
    def start(x: Any, u: Any, p: Any, work: Any) -> None:
        state, given, constants = record_of(x, X), record_of(u, U), record_of(p, P)
        w = workspace_in(borrow(work), nodes, layers)
        forget_factors(w)
        if state.grid_scale == 0.0:
            begin_state(state, given, constants, build_laws(constants), w)

    @kernel
    def carry(x: Any, u: Any, p: Any, work: Any, q: Any) -> None:
        state, constants, w = record_of(x, X), record_of(p, P), workspace_in(borrow(work), nodes, layers)
        pressure, film = work[solver : solver + nodes], work[solver + nodes : solver + 2 * nodes]
        copy(pressure, state.pressure)
        copy(film, state.film)
        copy(w.heat.flat, state.temperature)
        laws, fluid = build_laws(constants), build_lubricant(constants, constants.density_law)
        flow = read_drives(record_of(u, U), constants, state.rigid_approach, filled).flow
        begin_heat(pressure, film, state.filling, state.grid_scale, flow, fluid, laws, w)
        properties(pressure, film, fluid, w.nodes)
        if filled:
            fill_partly(pressure, state.filling, w.nodes)
        masses(state.grid_scale, w, q[:nodes])
        rest = q[nodes:]
        if layers > 0:
            carry_heat(state, pressure, q[:nodes], rest, laws, w)
        rest[_SCALE], rest[_FILM], rest[_CURVATURE], rest[_APPROACH] = (
            state.grid_scale, state.film_thickness, state.curvature, state.rigid_approach,
        )  # fmt: skip

    @kernel
    def stage(x: Any, u: Any, p: Any, base: Any, interval: float, work: Any) -> int:
        state, given, constants = record_of(x, X), record_of(u, U), record_of(p, P)
        w = workspace_in(borrow(work), nodes, layers)
        # Vectors of their own, as in `make_field_advance`: those of a record would compile the solver again.
        pressure, film = work[solver : solver + nodes], work[solver + nodes : solver + 2 * nodes]
        copy(pressure, state.pressure)
        copy(film, state.film)
        bodies, fluid = build_bodies(constants), build_lubricant(constants, constants.density_law)
        laws, before = build_laws(constants), base[nodes:]
        drives = read_drives(given, constants, state.rigid_approach, filled)
        fill_total(pressure, film, bodies, w.mixed.total)
        load = integrate_pressure(w.mixed.total, w.weight, state.grid_scale)
        wanted = aimed_scale(state.grid_scale, load, central(film), drives.flow.radius, bodies)
        share = interval / GRID_TIME
        scale = (before[_SCALE] + share * wanted) / (1.0 + share)
        problem = FilmProblem(
            scale, (scale - before[_SCALE]) / interval, drives.flow, drives.line_load, interval
        )
        if layers > 0:
            take_heat(state, before, w)
        found = solve_film(pressure, film, drives.approach, problem, bodies, fluid, base[:nodes], laws, w)
        copy(state.pressure, pressure)
        copy(state.film, film)
        if found.error != 0.0:
            return NOT_CONVERGED
        if filled:
            end_filling(pressure, film, scale, interval, drives.flow, w)
            copy(state.filling, w.filling)
        state.grid_scale, state.rigid_approach = scale, found.approach
        if layers > 0:
            keep_heat(state, interval, 1.0, w)
        observe(state, given, constants, bodies, laws, w)
        state.film_rate = (state.film_thickness - before[_FILM]) / interval
        state.curvature_rate = (state.curvature - before[_CURVATURE]) / interval
        state.approach_rate = (found.approach - before[_APPROACH]) / interval
        return OK

    heat = 2 + nodes * (1 + int(rows_of(layers))) if layers else 0
    return ImplicitSteps(nodes + 4 + heat, solver + 2 * nodes, start, carry, stage)
