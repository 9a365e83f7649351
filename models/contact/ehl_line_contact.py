"""Lubricated line contact whose film is solved for in every step: Reynolds, elasticity, load balance.

Pressure and film over the nodes of a grid, its scale and what outputs need are states that no variable shows.
`line.transient` has the equations, `line.field` the steps. Load from the approach of the bodies, film out; or
with `load_is_given` (adherence form) film and approach from the load.

The field begins in the first step. Before, outputs are those of Hertz's contact over `film_thickness`, which
relaxes to Moes' and Venner's steady film: an equilibrium at the start has that film.
"""

from dataclasses import dataclass
from typing import Any

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component
from ..core.quantities import Layout, Quantity, join
from ..core.requirements import require
from .films import FILMS, moes_venner
from .films.groups import find_conditions
from .fluid import DENSITY_LAWS
from .hertz import half_width, load_and_deflection, pair_compliance
from .line.energies import make_field_energy
from .line.field import field_work_size, make_field_advance
from .line.field_state import clear, field_layout, fill_rates, load_share
from .line.heat_state import FilmHeatOutputs, FilmHeatParameters
from .line.implicit import implicit_field
from .mixed_lubrication import fill_surface_outputs, film_ratio
from .records import BONDS, ContactInputs, SharedOutputs, SharedParameters, feedthrough_of_load
from .relaxation import SQUEEZE_CONSTANT, relaxation_rate

# A tenth of it takes 2.5 times as long. At 1e-9 a swing of the approach ends with a load 2e-8 from that of
# 1e-11, much closer than `line.newton` promises (1e-6 of the pressure): less would only take time.
LEAST_FIELD_TOLERANCE = 1e-9
NODES = 301
# A layer (m) that fills any gap.
FLOODED = 1.0
# Before the field begins, asperities and film share the load by this formula.
MOES_VENNER = float(list(FILMS).index("moes_venner"))


@dataclass
class LineContactParameters(SharedParameters):
    """Defaults: the set `kushwaha2000`."""

    density_law: float = Quantity("1", "density under pressure", choices=DENSITY_LAWS).default()
    field_tolerance: float = Quantity(
        "1", "error of load and film per micro-step", minimum=LEAST_FIELD_TOLERANCE, maximum=0.1
    ).default(1e-4)
    oil_supply: float = kinds.FILM(
        "layer of oil that enters (structure mass_conserving = 1); 1 m: flooded", FLOODED,
        minimum=0.0, maximum=FLOODED,
    )  # fmt: skip


@dataclass
class LineContactOutputs(SharedOutputs):
    separated: float = kinds.SWITCH("the contact carries no load")


@dataclass
class KeptOilOutputs:
    """Of cavities that keep their oil."""

    oil_volume: float = Quantity("m3", "oil on the grid", nominal=1e-12).default()


@kernel
def steady_film(hertz_load: float, compliance: float, u: ContactInputs, p: LineContactParameters) -> float:
    """The film (m) of Moes and Venner under a load (N)."""
    return moes_venner.film(max(hertz_load, p.film_load_floor), find_conditions(u, compliance, p))


@kernel
def film_rate(x: Any, steady: float, u: ContactInputs) -> float:
    """dh/dt of the central film (m/s)."""
    if x.grid_scale > 0.0:
        return float(x.film_rate)
    return relaxation_rate(x.film_thickness, steady, u.entraining_velocity, SQUEEZE_CONSTANT)


@kernel
def derivative(t: float, x: Any, u: ContactInputs, p: LineContactParameters, dx: Any) -> None:
    """The rates that outputs need; pressure and film themselves move by steps only."""
    clear(dx)
    if x.grid_scale > 0.0:
        fill_rates(x, dx)
    else:
        compliance = pair_compliance(p)
        hertz_load, _ = load_and_deflection(x.film_thickness, compliance, u, p)
        dx.film_thickness = film_rate(x, steady_film(hertz_load, compliance, u, p), u)


@kernel
def output(t: float, x: Any, u: ContactInputs, p: LineContactParameters, y: LineContactOutputs) -> None:
    compliance, radius = pair_compliance(p), u.radius_of_curvature
    hertz_load, y.deflection = load_and_deflection(x.film_thickness, compliance, u, p)
    y.film_thickness = x.film_thickness
    y.steady_film_thickness = steady_film(hertz_load, compliance, u, p)
    y.squeeze_velocity = film_rate(x, y.steady_film_thickness, u)
    if x.grid_scale == 0.0:
        y.load = hertz_load
        y.minimum_film_thickness = x.film_thickness
        fill_surface_outputs(hertz_load, x.film_thickness, compliance, MOES_VENNER, u, p, y)
    else:
        share = load_share(u, p)
        y.load = share * x.field_load
        y.minimum_film_thickness = x.least_film
        y.half_width = half_width(max(0.0, y.load), radius, p.length, compliance)
        y.maximum_pressure = share * x.highest_pressure
        y.asperity_load = share * x.field_asperity_load
        y.viscous_friction = share * x.field_shear
        y.boundary_friction = share * x.field_boundary_friction
        y.friction_force = y.viscous_friction + y.boundary_friction
    # Also of the film that the field will begin with, which is not thickened by a formula's sharing.
    y.film_ratio = film_ratio(x.film_thickness, p.roughness)
    y.separated = 1.0 if y.load <= 0.0 else 0.0


@require(
    "oil_supply = {0:g} m: must be 1 (flooded) where cavities refill as if full; set mass_conserving = 1 in "
    "the structure"
)
def is_flooded(p: LineContactParameters, numbers: Any) -> bool:
    numbers[0] = p.oil_supply
    return p.oil_supply >= FLOODED


def make_output(keeps_oil: bool, heated: bool) -> Any:
    """`output`, with what cavities that keep their oil and a heated film show besides."""

    @kernel
    def shown(t: float, x: Any, u: Any, p: Any, y: Any) -> None:
        output(t, x, u, p, y)
        if heated:
            y.film_temperature = p.oil_temperature + x.film_rise
            y.surface_temperature = p.oil_temperature + x.surface_rise
        if keeps_oil:
            y.oil_volume = x.oil_volume[0]

    return shown if keeps_oil or heated else output


def ehl_line_contact(nodes: int = NODES, mass_conserving: int = 0, layers: int = 0) -> Component:
    """The lubricated line contact with a pressure field of so many nodes; ValueError if they cannot be.

    mass_conserving = 1: cavities keep their oil (see `line.cavities`).
    `layers`: into how many the film is cut for its temperatures (see `line.heat`); 0: isothermal.
    """
    if mass_conserving not in (0, 1):
        raise ValueError(f"mass_conserving = {mass_conserving}: must be 0 or 1")
    inputs = Layout(ContactInputs)
    filled = nodes * mass_conserving
    state = field_layout(nodes, filled, layers)
    parameters: list[type] = [LineContactParameters]
    outputs: list[type] = [LineContactOutputs]
    if mass_conserving:
        outputs.insert(0, KeptOilOutputs)
    if layers:
        parameters.insert(0, FilmHeatParameters)
        outputs.insert(0, FilmHeatOutputs)
    surfaces = tuple(name for name in inputs.names if name != "sliding_velocity")
    rated = ("entraining_velocity", "applied_load", "radius_of_curvature", "approach", "retreat")
    return Component(
        name="ehl_line_contact",
        description="Elastohydrodynamic line contact with its pressure field: load and film thickness",
        roles=(roles.Contact(),),
        parameters=Layout(join(*parameters)),
        state=state,
        inputs=inputs,
        outputs=Layout(join(*outputs)),
        derivative=derivative,
        output=make_output(bool(mass_conserving), bool(layers)),
        energy=make_field_energy(nodes, filled, layers),
        feedthrough={
            **feedthrough_of_load(inputs, surfaces),
            "steady_film_thickness": rated,
            "squeeze_velocity": rated,
        },
        requirements=() if mass_conserving else (is_flooded,),
        bonds=BONDS,
        structure={"nodes": nodes, "mass_conserving": mass_conserving, "layers": layers},
        advance_maker=make_field_advance,
        extra_work=field_work_size(state.size, inputs.size, nodes, layers),
        implicit_maker=implicit_field,
        event_indicators=("deflection",),
    )
