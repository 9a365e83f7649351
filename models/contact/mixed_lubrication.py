"""Load sharing and friction of the contact's records: Hertzian pressure and a film of one thickness."""

import math
from typing import Any, NamedTuple

from ..compile.kernel import kernel
from .asperities import Asperities
from .fluid import DOWSON_HIGGINSON, build_lubricant
from .friction import Traction, hertzian_friction
from .heated_friction import Contact, HotFilm, Solid, build_cooling, heat_film
from .hertz import half_width, maximum_pressure
from .load_sharing import FilmFormula, share_load
from .rheology import Thermal


class MixedLubrication(NamedTuple):
    """Film under the fluid's share of the load (m), load on asperities (N) and friction (N)."""

    film: float
    asperity_load: float
    viscous_friction: float
    boundary_friction: float


@kernel
def build_surfaces(p: Any) -> Asperities:
    """The rough surfaces of a contact's parameters."""
    return Asperities(p.roughness, p.roughness_parameter, p.asperity_slope)


@kernel
def build_traction(p: Any) -> Traction:
    """The laws of friction of a contact's parameters."""
    return Traction(
        p.limiting_shear_stress, p.limiting_shear_coefficient, p.boundary_friction_coefficient,
        p.boundary_shear_stress, p.limiting_law,
    )  # fmt: skip


@kernel
def film_ratio(film: float, roughness: float) -> float:
    """Film over roughness; 0 between smooth surfaces, where there is none."""
    return film / roughness if roughness > 0.0 else 0.0


@kernel
def mixed_lubrication(
    load: float, film: float, width: float, compliance: float, film_model: float, u: Any, p: Any
) -> MixedLubrication:
    """Sharing of the load W >= 0 (N) under a film (m) of smooth surfaces, and the friction.

    `film_model` numbers the formula in FILMS by which the film thickens as asperities take load.
    """
    surfaces = build_surfaces(p)
    formula = FilmFormula(
        film_model, u.entraining_velocity, u.radius_of_curvature, p.length, compliance, p.viscosity,
        p.pressure_viscosity,
    )  # fmt: skip
    carried = share_load(load, film, 2.0 * width * p.length, surfaces, formula)
    fluid = build_lubricant(p, DOWSON_HIGGINSON)  # friction does not depend on the density
    friction = hertzian_friction(
        load,
        width,
        p.length,
        u.sliding_velocity,
        carried,
        fluid,
        surfaces,
        compliance,
        build_traction(p),
    )
    return MixedLubrication(carried.film, carried.asperity_load, friction.viscous, friction.boundary)


@kernel
def heat_contact(load: float, width: float, mixed: MixedLubrication, u: Any, p: Any) -> HotFilm:
    """Friction and temperatures of the same contact, of half width b > 0 (m), whose film its shear heats."""
    contact = Contact(width, p.length, u.sliding_velocity, u.entraining_velocity)
    solids = Solid(p.conductivity_1, p.heat_capacity_1), Solid(p.conductivity_2, p.heat_capacity_2)
    cooling = build_cooling(contact, solids[0], solids[1], p.oil_conductivity)
    pressure = 2.0 / math.pi * (load - mixed.asperity_load) / (width * p.length)
    return heat_film(
        pressure, mixed.film, mixed.boundary_friction, contact, cooling,
        build_lubricant(p, DOWSON_HIGGINSON), Thermal(p.oil_temperature, p.temperature_viscosity),
        build_traction(p),
    )  # fmt: skip


@kernel
def fill_surface_outputs(
    load: float, film: float, compliance: float, film_model: float, u: Any, p: Any, y: Any
) -> MixedLubrication:
    """Outputs y of a Hertzian contact under the load W >= 0 (N): width, pressure, sharing and friction."""
    y.half_width = half_width(load, u.radius_of_curvature, p.length, compliance)
    y.maximum_pressure = maximum_pressure(load, u.radius_of_curvature, p.length, compliance)
    mixed = mixed_lubrication(load, film, y.half_width, compliance, film_model, u, p)
    y.asperity_load = mixed.asperity_load
    y.film_ratio = film_ratio(mixed.film, p.roughness)
    y.viscous_friction = mixed.viscous_friction
    y.boundary_friction = mixed.boundary_friction
    y.friction_force = mixed.viscous_friction + mixed.boundary_friction
    return mixed
