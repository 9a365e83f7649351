"""Lubricated finite line contact: Hertzian load of the approach, film thickness by a relaxation equation.

Kushwaha et al. 2000 (K), equations (5)-(10), (37)-(39). K (10) with its squeeze term, solved for dh/dt,
is the relaxation dh/dt = -(|u|/C) ln(h/h_ss(W, u, R)), C = 96.775 (K (37) has the opposite sign of its
own text). As u -> 0 the film is kept. Other film formulas enter as h_ss.

Two forms: *compliant* (approach in, load and film out): the film fills the gap, so the elastic
deflection is delta = approach - retreat + h and W = W_Hertz(delta) (1 + c delta'/W_ref) >= 0; and
*adherence* (`load_is_given`): load in, film out.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component
from ..core.quantities import Condition, Quantity, Vector, layouts
from .films import FILMS, film_by_number
from .films.groups import find_conditions, groups
from .hertz import elastic_energy, load_and_deflection, maximum_pressure, pair_compliance
from .inlet_heating import thermal_reduction
from .mixed_lubrication import fill_surface_outputs, heat_contact
from .records import (
    BONDS,
    FILM_STATE,
    IF_FILM,
    OIL_CONDUCTIVITY,
    POSITIVE,
    TEMPERATURE_RISE,
    TEMPERATURE_VISCOSITY,
    ContactInputs,
    HeatParameters,
    SharedOutputs,
    SharedParameters,
    feedthrough_of_load,
)
from .relaxation import SQUEEZE_CONSTANT, relaxation_rate
from .rolling import rolling_friction

# Ranges of the groups in the regression behind K (10) (K Table 3), with E = pi / compliance.
TABLE_3 = {
    "material": (5700.0, 9650.0),
    "squeeze": (-0.005, 0.0),
    "load": (0.34e-6, 0.56e-5),
    "speed": (0.63e-11, 3.3e-11),
}
G_LOW, G_HIGH = TABLE_3["material"]
SQUEEZE_LOW, SQUEEZE_HIGH = TABLE_3["squeeze"]
W_LOW, W_HIGH = TABLE_3["load"]
U_LOW, U_HIGH = TABLE_3["speed"]


IF_LOAD_IS_FOUND = Condition(("load_is_given",), (False,))
IF_WARM = Condition(("inlet_heating", "film_heating"))
FILM_IS_DRY = float(list(FILMS).index("dry"))


@dataclass
class ContactParameters(HeatParameters, SharedParameters):
    """Defaults: the set `kushwaha2000`; damping ratio 0.05 of the 6.7 kHz contact mode at 450 N."""

    film_model: float = Quantity("1", "film thickness formula", choices=tuple(FILMS)).default()
    squeeze_constant: float = POSITIVE(
        "constant C of the squeeze term (K 10)", SQUEEZE_CONSTANT, nominal=100.0, only=IF_FILM
    )
    contact_damping: float = kinds.DAMPING(
        "damping c of the contact at the reference load", 920.0, nominal=1e3, only=IF_LOAD_IS_FOUND
    )
    damping_reference_load: float = kinds.FORCE(
        "load at which the damping is c; it grows with the load",
        450.0,
        positive=True,
        only=IF_LOAD_IS_FOUND,
    )
    inlet_heating: float = kinds.SWITCH("heat of shear in the inlet thins the film")
    temperature_viscosity: float = replace(TEMPERATURE_VISCOSITY, only=IF_WARM).default(0.03)
    oil_conductivity: float = replace(OIL_CONDUCTIVITY, only=IF_WARM).default(0.14)
    film_heating: float = kinds.SWITCH("heat of shear in the film thins the oil there")


@dataclass
class ContactState:
    film_thickness: float = FILM_STATE("lubricant film thickness h", 1e-6)


@dataclass
class ContactOutputs(SharedOutputs):
    damping_margin: float = kinds.NUMBER(
        "1 + c delta'/W_ref: where it is negative the damping takes the whole load"
    )
    separated: float = kinds.SWITCH("the contact carries no load")
    material_in_range: float = kinds.SWITCH("G inside K Table 3")
    squeeze_in_range: float = kinds.SWITCH("w_s inside K Table 3")
    load_in_range: float = kinds.SWITCH("W inside K Table 3")
    speed_in_range: float = kinds.SWITCH("U inside K Table 3")
    thermal_reduction: float = kinds.NUMBER("share phi_T of the film that heat in the inlet leaves", 1.0)
    surface_temperature_rise: float = TEMPERATURE_RISE(
        "mean rise of the surfaces over the oil's temperature, with film_heating"
    )
    film_temperature_rise: float = TEMPERATURE_RISE(
        "rise over the oil's temperature at which the film shears, with film_heating"
    )
    rolling_friction: float = Quantity(
        "N", "drag F_R of the oil on each surface, with the sign of the entraining velocity"
    ).default()


class Contact(NamedTuple):
    """What the state and inputs say about the contact at an instant."""

    compliance: float
    film: float
    steady_film: float
    thermal_reduction: float
    film_rate: float
    deflection: float
    deflection_rate: float
    elastic_load: float
    damping_margin: float
    load: float


@kernel
def damping_margin(deflection_rate: float, p: Any) -> float:
    """1 + c delta'/W_ref: the load over the elastic one; where it is negative the contact does not pull."""
    return float(1.0 + p.contact_damping * deflection_rate / p.damping_reference_load)


@kernel
def contact(x: ContactState, u: ContactInputs, p: ContactParameters) -> Contact:
    """Deflection, load and film rate. The film sees the elastic load, which keeps the law explicit."""
    compliance = pair_compliance(p)
    film = 0.0 if p.film_model == FILM_IS_DRY else x.film_thickness
    elastic_load, delta = load_and_deflection(film, compliance, u, p)
    film_load = max(elastic_load, p.film_load_floor)
    left = 1.0
    if p.inlet_heating != 0.0:
        left = thermal_reduction(
            maximum_pressure(film_load, u.radius_of_curvature, p.length, compliance), u.entraining_velocity,
            u.sliding_velocity, compliance, p.viscosity, p.temperature_viscosity, p.oil_conductivity,
        )  # fmt: skip
    steady = left * film_by_number(p.film_model, film_load, find_conditions(u, compliance, p))
    film_rate = relaxation_rate(x.film_thickness, steady, u.entraining_velocity, p.squeeze_constant)
    delta_rate = u.approach_rate - u.retreat_rate + film_rate
    if p.load_is_given != 0.0:
        margin = 1.0
        load = u.applied_load
    else:
        margin = damping_margin(delta_rate, p)
        load = elastic_load * max(0.0, margin)
    return Contact(compliance, film, steady, left, film_rate, delta, delta_rate, elastic_load, margin, load)


@kernel
def derivative(t: float, x: ContactState, u: ContactInputs, p: ContactParameters, dx: ContactState) -> None:
    dx.film_thickness = contact(x, u, p).film_rate


@kernel
def inside(value: float, low: float, high: float) -> float:
    return 1.0 if low <= value <= high else 0.0


@kernel
def output(t: float, x: ContactState, u: ContactInputs, p: ContactParameters, y: ContactOutputs) -> None:
    c = contact(x, u, p)
    speed = abs(u.entraining_velocity)
    y.load = c.load
    y.film_thickness = c.film
    y.minimum_film_thickness = c.film
    y.squeeze_velocity = c.film_rate
    y.steady_film_thickness = c.steady_film
    y.deflection = c.deflection
    load = max(0.0, c.load)
    shared_film = fill_surface_outputs(load, c.film, c.compliance, p.film_model, u, p, y)
    y.surface_temperature_rise = y.film_temperature_rise = 0.0
    if p.film_heating != 0.0 and load > 0.0:
        hot = heat_contact(load, shared_film, y, u, p)
        y.surface_temperature_rise, y.film_temperature_rise = hot.surface_rise, hot.film_rise
        y.viscous_friction = hot.viscous
        y.friction_force = hot.viscous + y.boundary_friction
    y.damping_margin = c.damping_margin
    y.separated = 1.0 if c.load <= 0.0 else 0.0
    at = find_conditions(u, c.compliance, p)
    g = groups(math.pi / c.compliance, load, at)
    y.material_in_range = inside(g.material, G_LOW, G_HIGH)
    # At rest the squeeze ratio has no value: out of range.
    y.squeeze_in_range = inside(c.film_rate / speed, SQUEEZE_LOW, SQUEEZE_HIGH) if speed > 0.0 else 0.0
    y.load_in_range = inside(g.load, W_LOW, W_HIGH)
    y.speed_in_range = inside(g.speed, U_LOW, U_HIGH)
    y.thermal_reduction = c.thermal_reduction
    heat = p.temperature_viscosity * p.viscosity * speed**2 / p.oil_conductivity if p.inlet_heating else 0.0
    y.rolling_friction = 0.0
    if p.film_model != FILM_IS_DRY:
        y.rolling_friction = rolling_friction(load, at, heat)


@kernel
def energy(t: float, x: ContactState, u: ContactInputs, p: ContactParameters, e: Vector) -> None:
    """Stored: elastic. Dissipated: contact damping. Source: the film growing under the load (the
    entrainment's work, negative while it is squeezed). A changing radius R gives it, through no bond, the
    power c W^2 R'/(2 pi L R), with the elastic load W and the compliance c of the bodies."""
    c = contact(x, u, p)
    e[0] = elastic_energy(c.elastic_load, u.radius_of_curvature, p.length, c.compliance)
    e[1] = (c.load - c.elastic_load) * c.deflection_rate
    e[2] = c.load * c.film_rate if p.film_model != FILM_IS_DRY else 0.0


def ehl_contact() -> Component:
    """The lubricated line contact whose film follows a formula, compliant or in adherence form."""
    records = layouts(ContactParameters, ContactState, ContactInputs, ContactOutputs)
    inputs = records["inputs"]
    # Sliding heats the inlet, so that the film, and with its damping the load, depend on it.
    surfaces = inputs.names
    rated = tuple(name for name in inputs.names if name not in ("approach_rate", "retreat_rate"))
    return Component(
        name="ehl_contact",
        description="Elastohydrodynamic finite line contact: load and film thickness",
        roles=(roles.Contact(), roles.RollingContact()),
        **records,
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            **feedthrough_of_load(inputs, surfaces),
            "squeeze_velocity": rated,
            "steady_film_thickness": rated,
            "damping_margin": surfaces,
            "squeeze_in_range": rated,
            "load_in_range": surfaces,
            "speed_in_range": ("entraining_velocity", "radius_of_curvature"),
            "thermal_reduction": rated,
            "surface_temperature_rise": inputs.names,
            "film_temperature_rise": inputs.names,
            "rolling_friction": surfaces,
        },
        bonds=BONDS,
        event_indicators=("deflection", "damping_margin"),
    )
