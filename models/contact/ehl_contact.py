"""Lubricated finite line contact: Hertzian load of the approach, film thickness by a relaxation equation.

Kushwaha et al. 2000 (K), equations (5)-(10), (37)-(39). K (10) with its squeeze term, solved for dh/dt,
is the relaxation dh/dt = -(|u|/C) ln(h/h_ss(W, u, R)), C = 96.775 (K (37) has the opposite sign of its
own text). As u -> 0 the film is kept. Other film formulas enter as h_ss.

Two forms: *compliant* (approach in, load and film out): the film fills the gap, so the elastic
deflection is delta = approach - retreat + h and W = W_Hertz(delta) (1 + c delta'/W_ref) >= 0; and
*adherence* (`load_is_given`): load in, film out.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..compile.kernel import kernel
from ..core.bonds import counts_energies
from ..core.component import Component, PowerBond
from ..core.quantities import Layout, Vector
from ..core.requirements import Requirement
from .films import FILMS, film_by_number
from .films.groups import groups
from .hertz import compliance_of, deflection, elastic_energy, half_width, load_of, maximum_pressure
from .line.field import with_field
from .mixed_lubrication import film_ratio, mixed_lubrication
from .records import ContactInputs, ContactOutputs, ContactParameters, ContactState

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


FILM_IS_DRY = float(list(FILMS).index("dry"))
FILM_IS_SOLVED = float(list(FILMS).index("line_transient"))


class Contact(NamedTuple):
    """What the state and inputs say about the contact at an instant."""

    compliance: float
    film: float
    steady_film: float
    film_rate: float
    deflection: float
    deflection_rate: float
    elastic_load: float
    damping_margin: float
    load: float


@kernel
def relaxation_rate(film: float, steady_film: float, velocity: float, squeeze_constant: float) -> float:
    """dh/dt = -(|u|/C) ln(h/h_ss): K (10) solved for its squeeze velocity; 0 at u = 0.

    A film that is not positive has no rate (nan): an integrator must reject the trial.
    """
    if velocity == 0.0 or steady_film <= 0.0:
        return 0.0
    if film <= 0.0:
        return math.nan
    return -abs(velocity) / squeeze_constant * math.log(film / steady_film)


@kernel
def contact(x: ContactState, u: ContactInputs, p: ContactParameters) -> Contact:
    """Deflection, load and film rate. The film sees the elastic load, which keeps the law explicit."""
    compliance = compliance_of(p)
    radius = u.radius_of_curvature
    film = 0.0 if p.film_model == FILM_IS_DRY else x.film_thickness
    if p.load_is_given != 0.0:
        elastic_load = max(0.0, u.applied_load)
        delta = deflection(elastic_load, radius, p.length, compliance)
    else:
        delta = u.approach - u.retreat + film
        elastic_load = load_of(delta, radius, p.length, compliance)
    steady = film_by_number(
        p.film_model, max(elastic_load, p.film_load_floor), abs(u.entraining_velocity), radius, p.length,
        compliance, p.viscosity, p.pressure_viscosity,
    )  # fmt: skip
    film_rate = relaxation_rate(x.film_thickness, steady, u.entraining_velocity, p.squeeze_constant)
    delta_rate = u.approach_rate - u.retreat_rate + film_rate
    if p.load_is_given != 0.0:
        margin = 1.0
        load = u.applied_load
    else:
        margin = 1.0 + p.contact_damping * delta_rate / p.damping_reference_load
        load = elastic_load * max(0.0, margin)
    return Contact(compliance, film, steady, film_rate, delta, delta_rate, elastic_load, margin, load)


@kernel
def derivative(t: float, x: ContactState, u: ContactInputs, p: ContactParameters, dx: ContactState) -> None:
    dx.film_thickness = contact(x, u, p).film_rate


@kernel
def inside(value: float, low: float, high: float) -> float:
    return 1.0 if low <= value <= high else 0.0


@kernel
def output(t: float, x: ContactState, u: ContactInputs, p: ContactParameters, y: ContactOutputs) -> None:
    c = contact(x, u, p)
    radius, speed = u.radius_of_curvature, abs(u.entraining_velocity)
    y.load = c.load
    y.film_thickness = c.film
    y.minimum_film_thickness = c.film
    y.squeeze_velocity = c.film_rate
    y.steady_film_thickness = c.steady_film
    y.deflection = c.deflection
    load = max(0.0, c.load)
    y.half_width = half_width(load, radius, p.length, c.compliance)
    y.maximum_pressure = maximum_pressure(load, radius, p.length, c.compliance)
    mixed = mixed_lubrication(load, c.film, y.half_width, c.compliance, u, p)
    y.asperity_load = mixed.asperity_load
    y.film_ratio = film_ratio(mixed.film, p.roughness)
    y.viscous_friction = mixed.viscous_friction
    y.boundary_friction = mixed.boundary_friction
    y.friction_force = mixed.viscous_friction + mixed.boundary_friction
    y.damping_margin = c.damping_margin
    y.separated = 1.0 if c.load <= 0.0 else 0.0
    g = groups(math.pi / c.compliance, load, speed, radius, p.length, p.viscosity, p.pressure_viscosity)
    y.material_in_range = inside(g.material, G_LOW, G_HIGH)
    # At rest the squeeze ratio has no value: out of range.
    y.squeeze_in_range = inside(c.film_rate / speed, SQUEEZE_LOW, SQUEEZE_HIGH) if speed > 0.0 else 0.0
    y.load_in_range = inside(g.load, W_LOW, W_HIGH)
    y.speed_in_range = inside(g.speed, U_LOW, U_HIGH)


@kernel
def energy(t: float, x: ContactState, u: ContactInputs, p: ContactParameters, e: Vector) -> None:
    """Stored: elastic. Dissipated: contact damping. Source: the film growing under the load (the
    entrainment's work, negative while it is squeezed); a changing radius adds dE/dR dR/dt."""
    c = contact(x, u, p)
    e[0] = elastic_energy(c.elastic_load, u.radius_of_curvature, p.length, c.compliance)
    e[1] = (c.load - c.elastic_load) * c.deflection_rate
    e[2] = c.load * c.film_rate if p.film_model != FILM_IS_DRY else 0.0


@kernel
def film_has_a_formula(p: ContactParameters, told: Vector) -> bool:
    """The film that is solved for needs a field."""
    return p.film_model != FILM_IS_SOLVED


REQUIREMENTS = (
    Requirement(
        film_has_a_formula,
        "film_model = line_transient: needs a pressure field; give the structural size nodes = 301, in "
        "Python (native FMUs have no field: their film follows formulas)",
    ),
)


@counts_energies
def ehl_contact(nodes: int = 0) -> Component:
    """The lubricated line contact, compliant or in adherence form.

    `nodes` of a pressure field, which the film model line_transient needs; 0: none. ValueError for a number
    of nodes that cannot be.
    """
    return with_field(_formula_contact(), nodes) if nodes else _formula_contact()


def _formula_contact() -> Component:
    """The contact without a field."""
    inputs = Layout(ContactInputs)
    surfaces = tuple(name for name in inputs.names if name != "sliding_velocity")
    statics = ("approach", "retreat", "applied_load", "radius_of_curvature")
    rated = ("entraining_velocity", "applied_load", "radius_of_curvature", "approach", "retreat")
    friction = inputs.names
    return Component(
        requirements=REQUIREMENTS,
        structure={"nodes": 0},
        name="ehl_contact",
        description="Elastohydrodynamic finite line contact: load and film thickness",
        parameters=Layout(ContactParameters),
        state=Layout(ContactState),
        inputs=inputs,
        outputs=Layout(ContactOutputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "load": surfaces,
            "squeeze_velocity": rated,
            "steady_film_thickness": rated,
            "deflection": statics,
            "half_width": surfaces,
            "maximum_pressure": surfaces,
            "friction_force": friction,
            "viscous_friction": friction,
            "asperity_load": surfaces,
            "film_ratio": surfaces,
            "boundary_friction": friction,
            "damping_margin": surfaces,
            "separated": surfaces,
            "squeeze_in_range": rated,
            "load_in_range": surfaces,
            "speed_in_range": ("entraining_velocity", "radius_of_curvature"),
        },
        bonds=(
            PowerBond("load", "approach_rate", +1),
            PowerBond("load", "retreat_rate", -1),
        ),
        event_indicators=("deflection", "damping_margin"),
    )
