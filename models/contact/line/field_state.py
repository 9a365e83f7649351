"""The state of a contact whose film is solved for: what its field is, begins as and shows.

Outputs have their rates from `differences` of what is seen at the ends of micro-steps.
"""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from ...compile.kernel import kernel, shaped
from ...core.quantities import Layout, Quantity
from ..asperities import dry_separation, pressure_scale
from ..fluid import build_lubricant
from ..friction import profile_friction, shear_stress
from ..hertz import deflection, find_load, maximum_pressure, pair_compliance
from ..mixed_lubrication import build_surfaces
from ..records import FILM_STATE
from .cavities import start_filling, volume_on_grid
from .differences import INSTANTS, append_instant, estimate_rate, estimate_second_derivative, restart
from .grid import check_nodes
from .heat_state import check_layers
from .heated import is_heated
from .mixed import Bodies, fill_total, film_of, mean_plane_gap
from .newton import integrate_pressure
from .reynolds import Flow
from .shear import HeatLaws
from .transient import Drives, central, grid_scale_after, highest, least, place_film, wanted_scale
from .workspace import Workspace, rows_of

# Whose rates outputs need.
FOLLOWED = 7
_LOAD, _FILM, _LEAST, _PRESSURE, _ASPERITIES, _SHEAR, _BOUNDARY = range(FOLLOWED)


def field_layout(nodes: int, filled: int, layers: int = 0) -> Layout:
    """The state of a contact with so many nodes, `filled` of which know how full they are, and temperatures
    in so many layers of the film."""
    check_nodes(nodes)
    check_layers(layers)
    number, time = Quantity("1", internal=True), Quantity("s", internal=True)
    distance, velocity = Quantity("m", internal=True), Quantity("m/s", internal=True)
    thin, load = replace(distance, nominal=1e-6), Quantity("N", nominal=500.0, internal=True)
    pressed = Quantity("Pa", nominal=1e8, internal=True)
    rise = Quantity("K", nominal=10.0, internal=True)
    rise_rate = Quantity("K/s", nominal=1e4, internal=True)

    @dataclass
    class FieldState:
        film_thickness: float = FILM_STATE("lubricant film thickness h", 1e-6)
        field_load: float = load("load of the pressure field")
        least_film: float = thin("smallest film")
        highest_pressure: float = pressed("largest pressure")
        film_rate: float = velocity("rate of the central film", nominal=1e-3)
        field_asperity_load: float = load("load on asperities")
        field_shear: float = load("shear of the film", nominal=20.0)
        field_boundary_friction: float = load("friction of asperities", nominal=20.0)
        rigid_approach: float = distance("approach of the bodies")
        approach_rate: float = velocity("its rate where the load is given")
        curvature: float = Quantity("1/m", "1/R of the gap", nominal=50.0, internal=True).default()
        curvature_rate: float = Quantity("1/(m.s)", "its rate", nominal=50.0, internal=True).default()
        grid_scale: float = distance("scale of the grid; 0: not begun")
        pressure: Any = pressed.each("pressure over the nodes", "nodes")
        film: Any = thin.each("film over the nodes", "nodes")
        slope: Any = Quantity("Pa/s", nominal=1e12, internal=True).each(
            "rate of pressure by which the next is foretold", "nodes"
        )
        filling: Any = number.each("oil over what fills the gap, over the nodes", "filled", 1.0)
        temperature: Any = rise.each("rise over nodes and rows", "temperature")
        temperature_slope: Any = rise_rate.each("rate of the rises at the last step's end", "temperature")
        micro_step: Any = time.each("length that the next micro-step may have; 0: any", "heated")
        film_rise: float = rise("largest in the film")
        film_rise_rate: float = rise_rate("its rate")
        surface_rise: float = rise("largest of the surfaces")
        surface_rise_rate: float = rise_rate("its rate")

        oil_volume: Any = Quantity("m3", nominal=1e-12, internal=True).each("oil on the grid", "kept")
        history: Any = number.each("divided differences of what outputs show (SI)", "history")
        ages: Any = time.each("ages of the instants in history", "ages")
        waited: float = time("time since the last of them")

    kept = min(filled, 1)
    sizes = {
        "nodes": nodes,
        "filled": filled,
        "kept": kept,
        "temperature": nodes * int(rows_of(layers)),
        "heated": min(layers, 1),
        "history": INSTANTS * (FOLLOWED + kept),
        "ages": INSTANTS - 1,
    }
    return Layout(FieldState, sizes)


@kernel
def build_bodies(p: Any) -> Bodies:
    """The elastic pair and its rough surfaces that the parameters describe."""
    compliance = pair_compliance(p)
    surfaces = build_surfaces(p)
    scale = pressure_scale(surfaces, compliance)
    return Bodies(compliance, p.length, p.roughness, scale, surfaces.roughness_parameter)


@kernel
def read_drives(u: Any, p: Any, approach: float, filled: int) -> Drives:
    """What the inputs ask for; `approach` is the guess where the load is given, `filled` that of the state.

    A load is at least film_load_floor: without any, the bodies would part at once, however far.
    """
    flow = Flow(
        u.entraining_velocity, u.sliding_velocity, u.radius_of_curvature, p.oil_supply if filled else -1.0
    )
    if p.load_is_given != 0.0:
        return Drives(flow, approach, max(u.applied_load, p.film_load_floor) / p.length)
    return Drives(flow, u.approach - u.retreat, -1.0)


@kernel
def load_share(u: Any, p: Any) -> float:
    """The load over that which the film is solved for: less than 1 for a load below film_load_floor.

    Without load there is no film to solve for, as the bodies part at once; they keep that of the floor. Of
    the forces on it, and the pressure, outputs show this share: nothing without load, all at the floor.
    """
    if p.load_is_given == 0.0:
        return 1.0
    return min(max(u.applied_load, 0.0) / p.film_load_floor, 1.0)


@kernel
def fill_stress(x: Any, u: Any, p: Any, laws: HeatLaws, w: Workspace) -> None:
    """The film's shear stress: that of an isothermal film; a heated one has its own from its step."""
    if is_heated(laws):
        return
    fluid = build_lubricant(p, p.density_law)
    for i in range(w.X.shape[0]):
        w.heat.stress[i] = shear_stress(x.pressure[i], u.sliding_velocity, x.film[i], fluid, laws.traction)


@kernel
def observe(x: Any, u: Any, p: Any, bodies: Bodies, laws: HeatLaws, w: Workspace) -> None:
    """The numbers that outputs need, from pressure and film: load, films, and what rubs."""
    fill_total(x.pressure, x.film, bodies, w.mixed.total)
    x.curvature = 1.0 / u.radius_of_curvature
    x.field_load = integrate_pressure(w.mixed.total, w.weight, x.grid_scale) * bodies.length
    x.film_thickness = central(x.film)
    x.least_film = least(x.film)
    x.highest_pressure = highest(w.mixed.total)
    fill_stress(x, u, p, laws, w)
    found = profile_friction(
        w.X, x.pressure, x.film, w.heat.stress, x.grid_scale * bodies.length, u.sliding_velocity,
        bodies.compliance, build_surfaces(p), laws.traction,
    )  # fmt: skip
    x.field_asperity_load = found.asperity_load
    x.field_shear = found.viscous
    x.field_boundary_friction = found.boundary
    for i in range(x.oil_volume.shape[0]):
        volume = volume_on_grid(x.pressure, x.film, x.filling, w.X, build_lubricant(p, p.density_law))
        x.oil_volume[i] = volume * x.grid_scale * bodies.length


@kernel
def history_table(x: Any) -> Any:
    """Divided differences, a row for each order."""
    return shaped(x.history, (INSTANTS, FOLLOWED + x.oil_volume.shape[0]))


@kernel
def remember(x: Any, time_step: float, values: Any) -> None:
    """What was observed joins the history, `time_step` (s) after the last instant; 0: as its first.

    `values`: scratch of FOLLOWED elements and one for oil that is kept.
    """
    values[_LOAD], values[_FILM], values[_LEAST] = x.field_load, x.film_thickness, x.least_film
    values[_PRESSURE], values[_ASPERITIES] = x.highest_pressure, x.field_asperity_load
    values[_SHEAR], values[_BOUNDARY] = x.field_shear, x.field_boundary_friction
    table = history_table(x)
    for i in range(x.oil_volume.shape[0]):
        values[FOLLOWED + i] = x.oil_volume[i]
    if time_step <= 0.0:
        restart(table, x.ages, values)
        x.waited = 0.0
    elif append_instant(table, x.ages, values, x.waited + time_step):
        x.waited = 0.0
    else:
        x.waited += time_step
    x.film_rate = estimate_rate(table, x.ages, _FILM, x.waited)


@kernel
def clear(dx: Any) -> None:
    """Nothing moves."""
    dx.film_thickness, dx.field_load, dx.least_film, dx.highest_pressure = 0.0, 0.0, 0.0, 0.0
    dx.film_rate, dx.field_asperity_load, dx.field_shear, dx.field_boundary_friction = 0.0, 0.0, 0.0, 0.0
    dx.rigid_approach, dx.approach_rate, dx.curvature, dx.curvature_rate = 0.0, 0.0, 0.0, 0.0
    dx.grid_scale, dx.waited = 0.0, 0.0
    dx.pressure[:] = 0.0
    dx.film[:] = 0.0
    dx.slope[:] = 0.0
    dx.filling[:] = 0.0
    dx.oil_volume[:] = 0.0
    dx.temperature[:] = 0.0
    dx.temperature_slope[:] = 0.0
    dx.micro_step[:] = 0.0
    dx.film_rise, dx.film_rise_rate, dx.surface_rise, dx.surface_rise_rate = 0.0, 0.0, 0.0, 0.0
    dx.history[:] = 0.0
    dx.ages[:] = 0.0


@kernel
def fill_rates(x: Any, dx: Any) -> None:
    """Rates of what outputs show."""
    table = history_table(x)
    dx.field_load = estimate_rate(table, x.ages, _LOAD, x.waited)
    dx.film_thickness = x.film_rate
    dx.film_rise, dx.surface_rise = x.film_rise_rate, x.surface_rise_rate
    dx.film_rate = estimate_second_derivative(table, x.ages, _FILM)
    dx.least_film = estimate_rate(table, x.ages, _LEAST, x.waited)
    dx.highest_pressure = estimate_rate(table, x.ages, _PRESSURE, x.waited)
    dx.field_asperity_load = estimate_rate(table, x.ages, _ASPERITIES, x.waited)
    dx.field_shear = estimate_rate(table, x.ages, _SHEAR, x.waited)
    dx.field_boundary_friction = estimate_rate(table, x.ages, _BOUNDARY, x.waited)
    for i in range(x.oil_volume.shape[0]):
        dx.oil_volume[i] = estimate_rate(table, x.ages, FOLLOWED + i, x.waited)


@kernel
def next_scale(x: Any, radius: float, time_step: float, bodies: Bodies) -> float:
    """The grid's scale after a step in whose middle the contact has that radius (m)."""
    table = history_table(x)
    load = x.field_load + 0.5 * time_step * estimate_rate(table, x.ages, _LOAD, x.waited)
    film = x.film_thickness + 0.5 * time_step * x.film_rate
    return grid_scale_after(time_step, x.grid_scale, load / bodies.length, film, radius, bodies)


class Begun(NamedTuple):
    """Scale of the grid (m) and approach of the bodies (m) of a field that begins."""

    grid_scale: float
    rigid_approach: float


@kernel
def begin(thickness: float, u: Any, p: Any, X: Any, pressure: Any, film: Any) -> Begun:
    """Fill pressure and film: Hertz's pressure over a film of that thickness (m)."""
    bodies = build_bodies(p)
    between, radius = mean_plane_gap(thickness, bodies.roughness), u.radius_of_curvature
    if p.load_is_given != 0.0:
        load = max(u.applied_load, p.film_load_floor)
        if bodies.roughness > 0.0:
            # No film presses rough surfaces closer than they come dry.
            highest_pressure = maximum_pressure(load, radius, bodies.length, bodies.compliance)
            dry = dry_separation(highest_pressure, build_surfaces(p), bodies.compliance)
            between = max(between, dry * bodies.roughness)
        approach = deflection(load, radius, bodies.length, bodies.compliance) - between
        gap = between
    else:
        approach = u.approach - u.retreat
        load = find_load(approach + between, radius, bodies.length, bodies.compliance)
        gap = between if load > 0.0 else -approach
    scale = wanted_scale(load / bodies.length, film_of(gap, bodies.roughness), radius, bodies)
    place_film(load, gap, radius, bodies, X, scale, pressure, film)
    return Begun(scale, approach)


@kernel
def begin_state(x: Any, u: Any, p: Any, laws: HeatLaws, w: Workspace) -> None:
    """Begin the field of a state that has none."""
    begun = begin(x.film_thickness, u, p, w.X, x.pressure, x.film)
    x.grid_scale, x.rigid_approach = begun.grid_scale, begun.rigid_approach
    start_filling(x.pressure, x.film, p.oil_supply, x.filling)
    if is_heated(laws):
        w.heat.stress[:] = 0.0
    observe(x, u, p, build_bodies(p), laws, w)
