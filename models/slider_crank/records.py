"""Parameters, state, inputs and outputs of the slider-crank with clearance."""

import math
from dataclasses import dataclass
from typing import Annotated

from .. import kinds
from ..compile.kernel import kernel
from ..plausible import PLAY
from .crank import CrankAcceleration, CrankImpulse, CrankSpeed
from .equations import THESIS_ALPHA, THESIS_BETA, THESIS_XI, Crank, Mechanism
from .forms import AS_PUBLISHED, CORRECTED

# F section 4.1 gives M = 0.00210 lbf s^2/in and l = 5.4570 in (exact conversions: 4.4482216152605 N/lbf,
# 0.0254 m/in). r, m and J_r follow from F's rounded xi, alpha, beta, which its results were made with;
# F's own 1.6535 in, 0.00399 lbf s^2/in, 0.0295 lbf s^2 in agree within 0.04 %.
_POUND_FORCE, _INCH = 4.4482216152605, 0.0254
_PISTON_MASS = 0.00210 * _POUND_FORCE / _INCH
_ROD_LENGTH = 5.4570 * _INCH
# F's lambda = 0.05 at 1000 r/min and rho = 0.015: a periodic motion.
_FRICTION = 0.05 * _PISTON_MASS * _ROD_LENGTH**2 * 1000.0 * math.pi / 30.0
_CLEARANCE = 0.015 * _ROD_LENGTH
# Film and wall make a loop: the film's acceleration loads the wall, whose load sets the film. With a film
# that grows by the load's power n, entrained at u, it is unstable where F < n m u / (2 C T) (C of K 10, m the
# slider's effective mass): 20 N with the engine's defaults, n = 0.059 and u = 5 m/s. A wall that follows 2 T
# late is off by 0.1 um at the fastest film there, 1 mm/s.
FILM_LAG = 50e-6


@dataclass
class Parameters:
    """Defaults: the engine of F section 4.1. The roller's radius is chosen here, F gives none."""

    form: float = kinds.NUMBER(
        "equation of motion: F's own, with +beta, or without the small-angle step",
        CORRECTED,
        choices=("as_published", "corrected", "nonlinear"),
    )
    crank_radius: float = kinds.LENGTH("crank radius r", THESIS_XI * _ROD_LENGTH)
    rod_length: float = kinds.LENGTH("length l of the connecting rod", _ROD_LENGTH)
    rod_mass: float = kinds.PART_MASS(
        "mass m of the connecting rod, centre in its middle", THESIS_ALPHA * _PISTON_MASS, minimum=0.0
    )
    rod_inertia: float = kinds.ROD_INERTIA(
        "inertia J_r of the connecting rod about its centre", THESIS_BETA * _PISTON_MASS * _ROD_LENGTH**2
    )
    piston_mass: float = kinds.PART_MASS("mass M of the piston (roller)", _PISTON_MASS, positive=True)
    joint_friction: float = kinds.TURNING_DAMPING(
        "friction moment c2 of the crank pin per relative speed", _FRICTION, nominal=0.1
    )
    clearance: float = kinds.DISPLACEMENT(
        "travel d - r* from the centre to either wall", _CLEARANCE, minimum=0.0, plausible=PLAY
    )
    restitution: float = kinds.NUMBER("coefficient of restitution e", 0.9, minimum=0.0, maximum=1.0)
    # F used 0.005; chatter ends by itself without it (see `slider_crank`).
    sliding_threshold: float = kinds.NUMBER(
        "rebound rate of psi per crank speed, relative to the wall, below which a pressed slider slides",
        nominal=1e-3,
        minimum=0.0,
    )
    film_lag: float = kinds.TIME(
        "time constant of walls that follow their films: T^2 h'' + 2 T h' + h = film thickness",
        FILM_LAG,
        nominal=1e-5,
        positive=True,
        display_unit="us",
    )
    roller_radius: float = kinds.LENGTH("radius r* of the roller on the liner", 0.040)


WallMode = Annotated[
    float, kinds.COUNT.of("+1 sliding on the upper wall, -1 on the lower, 0 free", minimum=-1.0, maximum=1.0)
]


@dataclass
class State:
    psi: float = kinds.TILT("deviation of the connecting rod from its nominal angle", nominal=1e-2)
    psi_rate: float = kinds.ROTATION_RATE("rate of psi", nominal=1.0)
    mode: WallMode = 0.0
    upper_impact_count: float = kinds.COUNT("impacts on the upper wall")
    lower_impact_count: float = kinds.COUNT("impacts on the lower wall")
    upper_impact_impulse: float = kinds.IMPULSE("sum of the impulses given by the upper wall")
    lower_impact_impulse: float = kinds.IMPULSE("sum of the impulses given by the lower wall")
    upper_force_integral: float = kinds.IMPULSE("time integral of the upper wall's sliding force")
    lower_force_integral: float = kinds.IMPULSE("time integral of the lower wall's sliding force")
    crank_impact_impulse: CrankImpulse = 0.0
    last_impact_time: float = kinds.TIME("time of the last impact")
    last_impact_velocity: float = kinds.VELOCITY("velocity towards the wall just before the last impact")
    impact_loss: float = kinds.ENERGY("energy lost in impacts")
    impact_work: float = kinds.ENERGY("energy given in impacts by crank and moving film")
    upper_wall_film: float = kinds.FILM("film by which the upper wall stands in")
    upper_wall_film_rate: float = kinds.VELOCITY("rate of the upper wall's film", nominal=1e-3)
    lower_wall_film: float = kinds.FILM("film by which the lower wall stands in")
    lower_wall_film_rate: float = kinds.VELOCITY("rate of the lower wall's film", nominal=1e-3)
    event_count: float = kinds.COUNT("impacts and releases")
    last_event_time: float = kinds.TIME("time of the last impact or release")


# The states by which the walls follow their films.
WALL_FILMS = ("upper_wall_film", "upper_wall_film_rate", "lower_wall_film", "lower_wall_film_rate")


@dataclass
class Inputs:
    """The films narrow the clearance; the walls follow them with `film_lag`."""

    crank_angle: float = kinds.ANGLE("crank angle theta, zero at top dead centre")
    crank_speed: CrankSpeed = 0.0
    crank_acceleration: CrankAcceleration = 0.0
    upper_film_thickness: float = kinds.FILM("lubricant film on the upper wall")
    lower_film_thickness: float = kinds.FILM("lubricant film on the lower wall")


@dataclass
class Outputs:
    psi: float = kinds.TILT("deviation of the connecting rod from its nominal angle", nominal=1e-2)
    psi_rate: float = kinds.ROTATION_RATE("rate of psi", nominal=1.0)
    piston_position: float = kinds.PLACE("piston position from the crank's centre along the cylinder")
    piston_velocity: float = kinds.VELOCITY("piston velocity along the cylinder")
    piston_offset: float = kinds.DISPLACEMENT("piston position across the cylinder, upwards")
    upper_wall_force: float = kinds.SIDE_FORCE("force of the upper wall on the sliding piston")
    lower_wall_force: float = kinds.SIDE_FORCE("force of the lower wall on the sliding piston")
    crank_torque: float = kinds.TORQUE("torque taken from the crank, between impacts")
    wall_entraining_velocity: float = kinds.VELOCITY(
        "mean surface velocity of roller and liner relative to their contact"
    )
    wall_sliding_velocity: float = kinds.VELOCITY("velocity of the roller over the liner")
    wall_radius: float = kinds.PLACE("reduced radius of roller and liner", display_unit="mm")
    sliding: WallMode = 0.0
    impact_count: float = kinds.COUNT("impacts on both walls")
    upper_impact_count: float = kinds.COUNT("impacts on the upper wall")
    lower_impact_count: float = kinds.COUNT("impacts on the lower wall")
    upper_impact_impulse: float = kinds.IMPULSE("sum of the impulses given by the upper wall")
    lower_impact_impulse: float = kinds.IMPULSE("sum of the impulses given by the lower wall")
    upper_wall_impulse: float = kinds.IMPULSE(
        "upper wall's impulses and integral of its force: differences give means"
    )
    lower_wall_impulse: float = kinds.IMPULSE(
        "lower wall's impulses and integral of its force: differences give means"
    )
    crank_impact_impulse: CrankImpulse = 0.0
    last_impact_time: float = kinds.TIME("time of the last impact")
    last_impact_velocity: float = kinds.VELOCITY("velocity towards the wall just before the last impact")
    event_count: float = kinds.COUNT("impacts and releases")
    last_event_time: float = kinds.TIME("time of the last impact or release")


@kernel
def crank(u: Inputs) -> Crank:
    return Crank(u.crank_angle, u.crank_speed, u.crank_acceleration)


@kernel
def mechanism(p: Parameters) -> Mechanism:
    """The dimensionless numbers, with damping c2 / (M l^2) in 1/s."""
    scale = p.piston_mass * p.rod_length**2
    beta = p.rod_inertia / scale
    sign = -1.0 if p.form == AS_PUBLISHED else 1.0
    return Mechanism(
        p.crank_radius / p.rod_length, p.rod_mass / p.piston_mass, beta, sign * beta, p.joint_friction / scale
    )
