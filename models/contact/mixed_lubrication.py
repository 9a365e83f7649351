"""Load sharing and friction of the contact's records: Hertzian pressure and a film of one thickness."""

import math
from typing import Any

from ..compile.kernel import kernel
from .asperities import Asperities
from .films.groups import find_conditions
from .fluid import DOWSON_HIGGINSON, build_lubricant
from .friction import Traction, hertzian_friction
from .heated_friction import Contact, HotFilm, Solid, build_cooling, heat_film
from .hertz import half_width, maximum_pressure
from .load_sharing import share_load
from .rheology import Thermal


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
def heat_contact(load: float, film: float, y: Any, u: Any, p: Any) -> HotFilm:
    """Friction and temperatures of a contact with the outputs y, whose film (m) its shear heats."""
    width = y.half_width
    contact = Contact(width, p.length, u.sliding_velocity, u.entraining_velocity)
    solids = Solid(p.conductivity_1, p.heat_capacity_1), Solid(p.conductivity_2, p.heat_capacity_2)
    cooling = build_cooling(contact, solids[0], solids[1], p.oil_conductivity)
    pressure = 2.0 / math.pi * (load - y.asperity_load) / (width * p.length)
    return heat_film(
        pressure, film, y.boundary_friction, contact, cooling,
        build_lubricant(p, DOWSON_HIGGINSON), Thermal(p.oil_temperature, p.temperature_viscosity),
        build_traction(p),
    )  # fmt: skip


@kernel
def fill_surface_outputs(
    load: float, film: float, compliance: float, film_model: float, u: Any, p: Any, y: Any
) -> float:
    """Outputs y of a Hertzian contact under the load W >= 0 (N) and a film (m) of smooth surfaces: width,
    pressure, sharing and friction; the film (m) under the fluid's share.

    `film_model` numbers the formula in FILMS by which the film thickens as asperities take load.
    """
    radius, surfaces = u.radius_of_curvature, build_surfaces(p)
    y.half_width = half_width(load, radius, p.length, compliance)
    y.maximum_pressure = maximum_pressure(load, radius, p.length, compliance)
    area, at = 2.0 * y.half_width * p.length, find_conditions(u, compliance, p)
    carried = share_load(load, film, area, surfaces, film_model, at)
    # Friction does not depend on the density.
    friction = hertzian_friction(
        load, y.half_width, p.length, u.sliding_velocity, carried, build_lubricant(p, DOWSON_HIGGINSON),
        surfaces, compliance, build_traction(p),
    )  # fmt: skip
    y.asperity_load = carried.asperity_load
    y.film_ratio = film_ratio(carried.film, p.roughness)
    y.viscous_friction, y.boundary_friction = friction.viscous, friction.boundary
    y.friction_force = friction.viscous + friction.boundary
    return carried.film
