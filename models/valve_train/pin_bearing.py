"""Plain bearing of a roller on its pin, or of a lever on its shaft, under a given load.

The film is that of `journal_bearing`. Here the load W along x is given, and the body that carries it does not
feel how far the pin sinks:

    mu R L^3/c^3 A u = W - N e/|e|,    e' = u + omega/2 k x e
    T = 2 pi mu R^3 L omega/(c sqrt(1 - eps^2)) + (force x e)/2 + T_N + T_F

Without load T is Petroff's. T_N is the dry friction of the asperities that carry N, with the limit mu_b N R,
which sticks (see `slider`). T_F shears the oil in the gaps h_F at both end faces of the roller:

    T_F = pi mu omega (R_F^4 - R^4)/h_F
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from .. import kinds
from ..compile.kernel import kernel
from ..contact.short_bearing import Squeeze
from ..core import roles
from ..core.component import Component, PowerBond
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Condition, Vector, layouts
from ..core.requirements import require
from . import journal_bearing as journal
from .journal_bearing import REQUIREMENTS, Film, Place, PlainBearingParameters
from .pivot_friction import RelaxationTime, TwistStiffness
from .slider import Slip, find_slip, lost_power


@dataclass
class Parameters(PlainBearingParameters):
    """Defaults: the bronze pin of a roller finger, with hot engine oil."""

    diameter: float = kinds.DIAMETER("diameter of the pin", 8e-3)
    width: float = kinds.WIDTH("width of the bearing", 8e-3)
    radial_clearance: float = kinds.CLEARANCE("radius of the bush less that of the pin", 15e-6)
    groove_angle: float = journal.GROOVE_ANGLE.default(0.5 * math.pi)
    sticking_stiffness: TwistStiffness = 50.0
    relaxation_time: RelaxationTime = 3e-5
    face_radius: float = kinds.DIAMETER(
        "outer radius R_F of the end faces", 7e-3, only=Condition(("face_gap",))
    )
    face_gap: float = kinds.PLACE(
        "gap h_F at each end face; 0: no faces", nominal=1e-4, minimum=0.0, display_unit="mm"
    )


@dataclass
class State(Place):
    twist: float = kinds.TILT("elastic twist of the asperities", nominal=1e-4)


@dataclass
class Inputs:
    rotation_rate: float = kinds.SPEED("speed omega of roller or lever on the pin")
    applied_load: float = kinds.FORCE("load W of the bearing")


@dataclass
class Outputs:
    friction_torque: float = kinds.FRICTION_TORQUE("torque T against the rotation")
    load: float = kinds.FORCE("load W of the bearing")
    eccentricity_ratio: float = kinds.NUMBER("eccentricity over the radial clearance")
    minimum_film_thickness: float = kinds.FILM("least thickness of the film")
    film_ratio: float = kinds.NUMBER("least film over roughness")
    maximum_pressure: float = kinds.PRESSURE("highest pressure of the film")
    asperity_load: float = kinds.FORCE("load N on the asperities")
    asperity_torque: float = kinds.FRICTION_TORQUE("share T_N of the asperities")
    sticking_margin: float = kinds.FRICTION_TORQUE(
        "limit of T_N less what sticking would take; negative: it slides"
    )
    power_loss: float = kinds.POWER("power T omega that friction takes from the rotation")


class Motion(NamedTuple):
    """Force on the film (N), the squeeze u (m/s), friction of asperities, and the whole torque (N m)."""

    force: Squeeze
    squeeze: Squeeze
    rubbed: Slip
    torque: float


@kernel
def shear_oil(film: Film, p: Parameters) -> float:
    """Torque over speed of the film all round, and of the end faces."""
    faces = 0.0
    if p.face_gap > 0.0:
        faces = math.pi * p.viscosity * (p.face_radius**4 - (0.5 * p.diameter) ** 4) / p.face_gap
    return journal.shear_film(film, p) + faces


@kernel
def move_film(film: Film, x: State, u: Inputs, p: Parameters) -> Motion:
    load = film.asperities.load
    pressed = load / film.eccentricity if load > 0.0 else 0.0
    force = Squeeze(u.applied_load - pressed * x.eccentricity_x, -pressed * x.eccentricity_y)
    unit, impedance = journal.squeeze_film(force, film, p), journal.film_impedance(p)
    limit = p.boundary_friction_coefficient * load * 0.5 * p.diameter
    rubbed = find_slip(x.twist, u.rotation_rate, limit, p.sticking_stiffness, p.relaxation_time)
    by_pressure = 0.5 * (force.x * x.eccentricity_y - force.y * x.eccentricity_x)
    torque = shear_oil(film, p) * u.rotation_rate + by_pressure + rubbed.transmitted
    return Motion(force, Squeeze(unit.x / impedance, unit.y / impedance), rubbed, torque)


@kernel
def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
    motion = move_film(journal.find_film(x, p), x, u, p)
    dx.eccentricity_x = motion.squeeze.x - 0.5 * u.rotation_rate * x.eccentricity_y
    dx.eccentricity_y = motion.squeeze.y + 0.5 * u.rotation_rate * x.eccentricity_x
    dx.twist = motion.rubbed.rate


@kernel
def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    film = journal.find_film(x, p)
    motion = move_film(film, x, u, p)
    y.friction_torque = motion.torque
    y.load = u.applied_load
    y.eccentricity_ratio = film.eccentricity / p.radial_clearance
    y.minimum_film_thickness = film.thinnest
    y.film_ratio = film.thinnest / p.roughness
    y.maximum_pressure = journal.press_film(motion.force, motion.squeeze, film, p)
    y.asperity_load = film.asperities.load
    y.asperity_torque = motion.rubbed.transmitted
    limit = p.boundary_friction_coefficient * film.asperities.load * 0.5 * p.diameter
    y.sticking_margin = limit - abs(motion.rubbed.sticking)
    y.power_loss = motion.torque * u.rotation_rate


@kernel
def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
    """Source: the load on the sinking pin."""
    film = journal.find_film(x, p)
    motion = move_film(film, x, u, p)
    e[0] = film.asperities.energy + 0.5 * p.sticking_stiffness * x.twist**2
    e[1] = motion.force.x * motion.squeeze.x + motion.force.y * motion.squeeze.y
    e[1] += shear_oil(film, p) * u.rotation_rate**2
    e[1] += lost_power(motion.rubbed, p.sticking_stiffness, p.relaxation_time)
    e[2] = u.applied_load * (motion.squeeze.x - 0.5 * u.rotation_rate * x.eccentricity_y)


@require("face_radius = {0:g} mm: must be > {1:g} mm, half of the pin's diameter")
def faces_are_outside(p: Parameters, numbers: Vector) -> bool:
    numbers[0], numbers[1] = 1e3 * p.face_radius, 0.5e3 * p.diameter
    return p.face_gap == 0.0 or p.face_radius > 0.5 * p.diameter


def pin_bearing() -> Component:
    """T = 2 pi mu R^3 L omega/(c sqrt(1 - eps^2)) + (force x e)/2 + T_N + T_F under a given load."""
    turning = ("rotation_rate", "applied_load")
    return Component(
        tolerance=FINE_TOLERANCE,
        name="pin_bearing",
        description="Plain bearing of a roller or lever under a given load",
        roles=(roles.Bearing(),),
        **layouts(Parameters, State, Inputs, Outputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "friction_torque": turning,
            "load": ("applied_load",),
            "maximum_pressure": ("applied_load",),
            "asperity_torque": ("rotation_rate",),
            "sticking_margin": ("rotation_rate",),
            "power_loss": turning,
        },
        bonds=(PowerBond("friction_torque", "rotation_rate", +1),),
        requirements=(*REQUIREMENTS, faces_are_outside),
        start_requirements=(journal.is_inside,),
        event_indicators=("sticking_margin",),
    )
