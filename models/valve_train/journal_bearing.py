"""Journal bearing: the journal of a shaft in an elastically held bush, with film and asperities between.

The film is short (`contact.short_bearing`), or also flows round the journal: all round a plain bush
(`contact.finite_bearing`), or on the two pads between axial grooves (`contact.grooved_bearing`). The bush has
no mass, and its support is a spring. The eccentricity e of the journal in the bush is a state, and the force
one of displacement:

    F = -k (a - e)      on the journal, with its axis at a
    e' = u + omega/2 k x e,      mu R L^3/c^3 A u = k (a - e) - N e/|e|

Without the support, the film would be a damper between the journal and the ground that is stiffer than any
explicit step of a coupling can bear. Asperities carry N where the film is thin; there the film's thickness is
the mean gap of the rough surfaces (Patir and Cheng 1978), which vanishes under no load.
"""

import math
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from .. import kinds, plausible
from ..compile.kernel import kernel
from ..contact.asperities import APART, Asperities, mean_gap
from ..contact.asperity_arc import Arc, AsperityForce, press_arc
from ..contact.finite_bearing import find_finite_squeeze, find_highest_pressure
from ..contact.grooved_bearing import Grooves, find_grooved_squeeze
from ..contact.grooved_pressure import find_grooved_pressure
from ..contact.short_bearing import Squeeze, find_squeeze, highest_pressure
from ..core import roles
from ..core.component import Component, PowerBond
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Condition, Vector, layouts
from ..core.requirements import require

# The film is no thinner than this part of the clearance, below any roughness. Over its square, 1e-15 is the
# rounding error of the mobility.
THINNEST = 1e-4
# Roughness over clearance below which the asperities are apart while the journal is in the middle.
ROUGHEST = 0.1
# Of the mean planes of rough surfaces that are pressed together, over the roughness: no load reaches it.
OVERLAP = 10.0
SHORT, FINITE, GROOVED = 0.0, 1.0, 2.0
IF_GROOVED = Condition(("film_model",), ("grooved",))
GROOVE_ANGLE = kinds.ANGLE.of(
    "from x to the middle of a groove; the other one is opposite", plausible=plausible.TURN, only=IF_GROOVED
)
# The search for the squeeze does not resolve narrower grooves. Pads are longer than a right angle.
NARROWEST_GROOVE, WIDEST_GROOVE = math.radians(1.0), 0.5 * math.pi
# Least L/D with grooves: narrower, the ends of the pads need closer steps.
NARROWEST = 0.1


Eccentricity = Annotated[float, kinds.DEFLECTION.of("eccentricity of the journal in the bush")]
Displacement = Annotated[float, kinds.DEFLECTION.of("displacement of the journal's axis")]


@dataclass
class PlainBearingParameters:
    """Defaults: a bearing of a camshaft, 25 mm, with hot engine oil."""

    diameter: float = kinds.DIAMETER("diameter of the journal", 25e-3)
    width: float = kinds.WIDTH("width of the bearing", 12e-3)
    radial_clearance: float = kinds.CLEARANCE("radius of the bush less that of the journal", 25e-6)
    viscosity: float = kinds.VISCOSITY("viscosity of the oil", 0.01)
    film_model: float = kinds.NUMBER(
        "Ocvirk's film, too thick in wide bearings; Reynolds' equation; that with two axial grooves",
        FINITE,
        choices=("short", "finite", "grooved"),
    )
    groove_angle: float = GROOVE_ANGLE.default()
    groove_width: float = kinds.ANGLE(
        "width of each groove",
        math.radians(20.0),
        positive=True,
        plausible=plausible.GROOVE,
        only=IF_GROOVED,
    )
    roughness: float = kinds.PLACE(
        "composite rms roughness", 0.4e-6, nominal=1e-7, positive=True, display_unit="um"
    )
    roughness_parameter: float = kinds.NUMBER(
        "density x radius x rms of asperities", 0.05, nominal=0.05, positive=True
    )
    asperity_slope: float = kinds.NUMBER("rms over radius of asperities", 1e-3, nominal=1e-3, positive=True)
    contact_modulus: float = kinds.YOUNGS_MODULUS(
        "modulus E of the contact, 1/E = (1 - nu1^2)/E1 + (1 - nu2^2)/E2", 58e9
    )
    boundary_friction_coefficient: float = kinds.FRICTION_COEFFICIENT(
        "friction coefficient of asperities", 0.1
    )


@dataclass
class Parameters(PlainBearingParameters):
    support_stiffness: float = kinds.SEAT_STIFFNESS(
        "radial stiffness of bush and housing", 2e8, nominal=1e8, positive=True
    )


@dataclass
class Place:
    eccentricity_x: Eccentricity = 0.0
    eccentricity_y: Eccentricity = 0.0


@dataclass
class Inputs:
    shaft_speed: float = kinds.SPEED("speed of the journal, anticlockwise")
    axis_x: Displacement = 0.0
    axis_y: Displacement = 0.0
    axis_velocity_x: float = kinds.VELOCITY("rate of axis_x", nominal=1e-2)
    axis_velocity_y: float = kinds.VELOCITY("rate of axis_y", nominal=1e-2)


@dataclass
class Outputs:
    force_x: float = kinds.FORCE("force on the journal")
    force_y: float = kinds.FORCE("force on the journal")
    friction_torque: float = kinds.FRICTION_TORQUE("torque that film and asperities take from the shaft")
    load: float = kinds.FORCE("force on the bush")
    eccentricity_x: Eccentricity = 0.0
    eccentricity_y: Eccentricity = 0.0
    eccentricity_ratio: float = kinds.NUMBER("eccentricity over the radial clearance")
    minimum_film_thickness: float = kinds.FILM(
        "least thickness of the film; to 0.1 % of Reynolds' equation up to an eccentricity of 0.95, grooved "
        "to 0.2 % for L/D >= 0.25"
    )
    film_ratio: float = kinds.NUMBER("least film over roughness")
    maximum_pressure: float = kinds.PRESSURE("highest pressure of the film")
    asperity_load: float = kinds.FORCE("load on the asperities")
    power_loss: float = kinds.POWER("power lost to friction and squeeze", nominal=10.0)


class Film(NamedTuple):
    """What the state says of the film: all of its eccentricity but the force on it."""

    eps: Squeeze
    eccentricity: float
    thinnest: float
    asperities: AsperityForce


class Motion(NamedTuple):
    """Force on the film (N), the squeeze velocity u (m/s) and the friction torque (N m)."""

    force: Squeeze
    squeeze: Squeeze
    torque: float


@kernel
def film_impedance(p: PlainBearingParameters) -> float:
    """mu R L^3/c^3 (N s/m)."""
    return p.viscosity * 0.5 * p.diameter * (p.width / p.radial_clearance) ** 3


@kernel
def find_film(x: Any, p: PlainBearingParameters) -> Film:
    """h = c - |e| while the surfaces are apart, else their mean gap."""
    e = math.sqrt(x.eccentricity_x**2 + x.eccentricity_y**2)
    separation = (p.radial_clearance - e) / p.roughness
    thinnest, share = p.radial_clearance - e, 1.0 / p.radial_clearance
    if separation < APART:
        thinnest = max(p.roughness * mean_gap(separation), THINNEST * p.radial_clearance)
        share = (1.0 - thinnest / p.radial_clearance) / e
    arc = Arc(0.5 * p.diameter, p.width, p.radial_clearance)
    surfaces = Asperities(p.roughness, p.roughness_parameter, p.asperity_slope)
    pressed = press_arc(separation, arc, surfaces, 1.0 / p.contact_modulus)
    return Film(Squeeze(share * x.eccentricity_x, share * x.eccentricity_y), e, thinnest, pressed)


@kernel
def shear_film(film: Film, p: PlainBearingParameters) -> float:
    """Torque of a film all round over the speed, 2 pi mu R^3 L/(c sqrt(1 - eps^2))."""
    radius, square = 0.5 * p.diameter, 1.0 - film.eps.x**2 - film.eps.y**2
    return 2.0 * math.pi * p.viscosity * radius**3 * p.width / (p.radial_clearance * math.sqrt(square))


@kernel
def rub(film: Film, u: Inputs, p: Parameters) -> float:
    """Torque of the asperities, against the speed; 0 at rest."""
    if u.shaft_speed == 0.0:
        return 0.0
    torque = p.boundary_friction_coefficient * film.asperities.load * 0.5 * p.diameter
    return math.copysign(torque, u.shaft_speed)


@kernel
def find_grooves(p: PlainBearingParameters) -> Grooves:
    return Grooves(p.width / p.diameter, p.groove_angle, p.groove_width)


@kernel
def squeeze_film(force: Squeeze, film: Film, p: PlainBearingParameters) -> Squeeze:
    """mu R L^3/c^3 u."""
    if p.film_model == SHORT:
        return find_squeeze(force, film.eps)
    if p.film_model == GROOVED:
        return find_grooved_squeeze(force, film.eps, find_grooves(p))
    return find_finite_squeeze(force, film.eps, p.width / p.diameter)


@kernel
def press_film(force: Squeeze, squeeze: Squeeze, film: Film, p: PlainBearingParameters) -> float:
    """The highest pressure (Pa) under a force (N), which moves the journal with the squeeze u (m/s)."""
    scale = 1.5 * p.viscosity * p.width**2 / p.radial_clearance**3
    if p.film_model == SHORT:
        return scale * highest_pressure(squeeze, film.eps)
    if p.film_model == GROOVED:
        return scale * find_grooved_pressure(squeeze, film.eps, find_grooves(p))
    return scale / film_impedance(p) * find_highest_pressure(force, film.eps, p.width / p.diameter)


@kernel
def move_film(film: Film, x: Place, u: Inputs, p: Parameters) -> Motion:
    """The film takes what the support gives and the asperities do not.

    T = 2 pi mu R^3 L omega/(c sqrt(1 - eps^2)) + (force x e)/2, and the torque of the asperities.
    """
    pressed = film.asperities.load / film.eccentricity if film.asperities.load > 0.0 else 0.0
    force = Squeeze(
        p.support_stiffness * (u.axis_x - x.eccentricity_x) - pressed * x.eccentricity_x,
        p.support_stiffness * (u.axis_y - x.eccentricity_y) - pressed * x.eccentricity_y,
    )
    unit = squeeze_film(force, film, p)
    impedance = film_impedance(p)
    by_pressure = 0.5 * (force.x * x.eccentricity_y - force.y * x.eccentricity_x)
    torque = shear_film(film, p) * u.shaft_speed + by_pressure + rub(film, u, p)
    return Motion(force, Squeeze(unit.x / impedance, unit.y / impedance), torque)


@kernel
def lost_power(film: Film, motion: Motion, u: Inputs, p: Parameters) -> float:
    """In squeeze, in shear and between asperities."""
    squeezed = motion.force.x * motion.squeeze.x + motion.force.y * motion.squeeze.y
    return squeezed + shear_film(film, p) * u.shaft_speed**2 + rub(film, u, p) * u.shaft_speed


@kernel
def derivative(t: float, x: Place, u: Inputs, p: Parameters, dx: Place) -> None:
    squeeze = move_film(find_film(x, p), x, u, p).squeeze
    dx.eccentricity_x = squeeze.x - 0.5 * u.shaft_speed * x.eccentricity_y
    dx.eccentricity_y = squeeze.y + 0.5 * u.shaft_speed * x.eccentricity_x


@kernel
def output(t: float, x: Place, u: Inputs, p: Parameters, y: Outputs) -> None:
    film = find_film(x, p)
    motion = move_film(film, x, u, p)
    y.force_x = p.support_stiffness * (x.eccentricity_x - u.axis_x)
    y.force_y = p.support_stiffness * (x.eccentricity_y - u.axis_y)
    y.load = math.sqrt(y.force_x**2 + y.force_y**2)
    y.friction_torque = motion.torque
    y.eccentricity_x, y.eccentricity_y = x.eccentricity_x, x.eccentricity_y
    y.eccentricity_ratio = film.eccentricity / p.radial_clearance
    y.minimum_film_thickness = film.thinnest
    y.film_ratio = film.thinnest / p.roughness
    y.maximum_pressure = press_film(motion.force, motion.squeeze, film, p)
    y.asperity_load = film.asperities.load
    y.power_loss = lost_power(film, motion, u, p)


@kernel
def energy(t: float, x: Place, u: Inputs, p: Parameters, e: Vector) -> None:
    film = find_film(x, p)
    bent = (u.axis_x - x.eccentricity_x) ** 2 + (u.axis_y - x.eccentricity_y) ** 2
    e[0] = 0.5 * p.support_stiffness * bent + film.asperities.energy
    e[1] = lost_power(film, move_film(film, x, u, p), u, p)
    e[2] = 0.0


@require("width = {0:g} mm: must be <= diameter = {1:g} mm; for longer bearings these films are not checked")
def is_short(p: PlainBearingParameters, numbers: Vector) -> bool:
    numbers[0], numbers[1] = 1e3 * p.width, 1e3 * p.diameter
    return p.width <= p.diameter


@require("roughness = {0:g} um: must be <= {1:g} um, a tenth of radial_clearance")
def is_smooth(p: PlainBearingParameters, numbers: Vector) -> bool:
    numbers[0], numbers[1] = 1e6 * p.roughness, 1e6 * ROUGHEST * p.radial_clearance
    return p.roughness <= ROUGHEST * p.radial_clearance


@require(
    "eccentricity_x = {0:g} um, eccentricity_y = {1:g} um: both together must be less than {2:g} um, "
    "radial_clearance + 10 roughness"
)
def is_inside(x: Any, u: Any, p: PlainBearingParameters, numbers: Vector) -> bool:
    farthest = p.radial_clearance + OVERLAP * p.roughness
    numbers[0], numbers[1], numbers[2] = 1e6 * x.eccentricity_x, 1e6 * x.eccentricity_y, 1e6 * farthest
    return x.eccentricity_x**2 + x.eccentricity_y**2 < farthest**2


@require(
    "groove_width = {0:g} rad ({1:g} deg): must be at least {2:g} and less than {3:g} deg for film_model = "
    "grooved"
)
def has_pads(p: PlainBearingParameters, numbers: Vector) -> bool:
    numbers[0], numbers[1] = p.groove_width, math.degrees(p.groove_width)
    numbers[2], numbers[3] = math.degrees(NARROWEST_GROOVE), math.degrees(WIDEST_GROOVE)
    return p.film_model != GROOVED or NARROWEST_GROOVE <= p.groove_width < WIDEST_GROOVE


@require("width = {0:g} mm: must be >= {1:g} mm, a tenth of the diameter, for film_model = grooved")
def is_resolved(p: PlainBearingParameters, numbers: Vector) -> bool:
    numbers[0], numbers[1] = 1e3 * p.width, 1e3 * NARROWEST * p.diameter
    return p.film_model != GROOVED or p.width >= NARROWEST * p.diameter


REQUIREMENTS = (is_short, is_smooth, has_pads, is_resolved)


def journal_bearing() -> Component:
    """F = -k (a - e) on the journal; e' = (mu R L^3/c^3 A)^-1 (-F - N e/|e|) + omega/2 k x e."""
    places = ("axis_x", "axis_y")
    return Component(
        tolerance=FINE_TOLERANCE,
        name="journal_bearing",
        description="Journal bearing: oil film, asperities and an elastic support",
        roles=(roles.Bearing(),),
        **layouts(Parameters, Place, Inputs, Outputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "force_x": ("axis_x",),
            "force_y": ("axis_y",),
            "load": places,
            "maximum_pressure": places,
            "friction_torque": ("shaft_speed", *places),
            "power_loss": ("shaft_speed", *places),
        },
        bonds=(
            PowerBond("friction_torque", "shaft_speed", +1),
            PowerBond("force_x", "axis_velocity_x", -1),
            PowerBond("force_y", "axis_velocity_y", -1),
        ),
        requirements=REQUIREMENTS,
        start_requirements=(is_inside,),
    )
