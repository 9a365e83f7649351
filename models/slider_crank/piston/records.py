"""Parameters, states, inputs and outputs of the slider-crank with a tilting piston."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ... import kinds
from ...core.quantities import Quantity, Vector
from ...plausible import OFFSET, PART_LENGTH, PLAY
from ..crank import (
    CrankAcceleration,
    CrankAngle,
    CrankImpulse,
    CrankRadius,
    CrankSpeed,
    GasPressure,
    RodLength,
)

# Flores, Leine and Glocker (2010), table 1; the gravity acts across the cylinder.
FLORES: Mapping[str, float] = {
    "crank_radius": 0.153,
    "rod_length": 0.306,
    "crank_mass": 0.038,
    "crank_centre": 0.5 * 0.153,
    "crank_inertia": 7.4e-5,
    "rod_mass": 0.038,
    "rod_centre": 0.5 * 0.306,
    "rod_inertia": 5.9e-4,
    "piston_mass": 0.076,
    "piston_inertia": 2.7e-6,
    "half_length": 0.05,
    "half_height": 0.025,
    "clearance": 0.001,
    "pin_height": 0.0,
    "pin_offset": 0.0,
    "mass_height": 0.0,
    "mass_offset": 0.0,
    "crank_pin_friction": 0.0,
    "piston_pin_friction": 0.0,
    "wall_friction": 0.01,
    "restitution": 0.4,
    "gravity_across": -9.81,
}

_BORE = 0.086


@dataclass
class PistonParameters:
    """Defaults: a petrol engine of 0.5 l a cylinder, chosen here: bore and stroke 86 mm, rod 3.3 crank
    radii long (Heywood 1988, 2.2: 3 to 4), the rest as is usual for that size. The crank's own mass is
    left to the flywheel that drives it."""

    crank_radius: CrankRadius = 0.5 * _BORE
    rod_length: RodLength = 0.143
    crank_mass: float = Quantity("kg", "mass of the crank", minimum=0.0).default()
    crank_centre: float = Quantity(
        "m", "distance of the crank's centre of mass from the shaft", nominal=0.1, display_unit="mm"
    ).default()
    crank_inertia: float = Quantity(
        "kg.m2", "inertia of the crank about its centre of mass", nominal=1e-3, minimum=0.0
    ).default()
    rod_mass: float = kinds.PART_MASS("mass of the connecting rod", minimum=0.0).default(0.55)
    rod_centre: float = Quantity(
        "m", "distance of the rod's centre of mass from the crank pin",
        nominal=0.1, minimum=0.0, display_unit="mm",
    ).default(0.042)  # fmt: skip
    rod_inertia: float = Quantity(
        "kg.m2", "inertia of the rod about its centre of mass", nominal=1e-3, minimum=0.0
    ).default(2.0e-3)
    piston_mass: float = kinds.PART_MASS("mass of the piston with its pin", positive=True).default(0.42)
    piston_inertia: float = kinds.INERTIA("inertia of the piston about its centre of mass").default(3.5e-4)
    half_length: float = Quantity(
        "m", "half the length of the skirt; 0: a roller, which touches each wall at one point",
        nominal=0.1, minimum=0.0, display_unit="mm", plausible=PART_LENGTH,
    ).default(0.025)  # fmt: skip
    half_height: float = Quantity(
        "m", "half the width of the piston across the bore",
        nominal=0.1, minimum=0.0, display_unit="mm", plausible=PART_LENGTH,
    ).default(0.5 * _BORE)  # fmt: skip
    clearance: float = kinds.GAP(
        "play of the middle piston to either wall", minimum=1e-7, plausible=PLAY
    ).default(40e-6)
    pin_height: float = kinds.DISTANCE("pin ahead of the skirt's middle, along", plausible=OFFSET).default(
        4e-3
    )
    pin_offset: float = kinds.OFFSET("pin above the piston's middle line (to the upper wall)").default()
    mass_height: float = kinds.DISTANCE(
        "centre of mass ahead of the skirt's middle, along", plausible=OFFSET
    ).default(8e-3)
    mass_offset: float = kinds.OFFSET("centre of mass above the piston's middle line").default()
    crank_pin_friction: float = kinds.TURNING_DAMPING(
        "friction moment of the crank pin per relative speed", nominal=1e-2
    ).default(1e-2)
    piston_pin_friction: float = kinds.TURNING_DAMPING(
        "friction moment of the piston pin per relative speed", nominal=1e-2
    ).default(2e-3)
    wall_friction: float = Quantity(
        "1", "coefficient of Coulomb friction mu at the walls", minimum=0.0, maximum=1.0
    ).default(0.05)
    # A piston passes 1 mm/s within a microsecond of its dead centre, so that this rounding off moves
    # nothing visible, and a piston at rest creeps instead of sticking.
    creep_velocity: float = kinds.VELOCITY(
        "sliding velocity below which lasting friction falls to zero (as tanh)", nominal=1e-3, positive=True
    ).default(1e-3)
    restitution: float = Quantity(
        "1", "coefficient of restitution e normal to the walls", minimum=0.0, maximum=1.0
    ).default(0.3)
    # Bounces of rebound v under a pressing acceleration a end after another 2 v / ((1 - e) a). Ended
    # early, the piston misses excursions of v^2/(2 a), at most a (1 - e)^2 time^2 / 8 (some 1e-12 m
    # here), and keeps its momentum: an impact gives at once what the bounces would have given.
    chatter_time: float = Quantity(
        "s", "bounces that would end within this time end at once, in contact", nominal=1e-7, minimum=0.0
    ).default(1e-7)
    gravity_along: float = Quantity(
        "m/s2", "gravity along the cylinder, + away from the crank", nominal=10.0
    ).default()
    gravity_across: float = Quantity(
        "m/s2", "gravity across the cylinder, + to the upper wall", nominal=10.0
    ).default()
    bore_area: float = Quantity(
        "m2", "area that the gas pressure acts on", nominal=1e-2, minimum=0.0
    ).default(0.25 * math.pi * _BORE**2)


@dataclass
class FreePistonParameters(PistonParameters):
    """As the other, with the inertia of a small flywheel on the crank."""

    crank_inertia: float = Quantity(
        "kg.m2", "inertia of the crank about its centre of mass", nominal=1e-3, minimum=0.0
    ).default(0.05)


@dataclass
class PistonState:
    """Corners in the order upper front, upper rear, lower front, lower rear; front is away from the crank."""

    offset: float = kinds.GAP("the piston's middle above the cylinder's axis").default()
    offset_rate: float = kinds.VELOCITY("rate of offset", nominal=1e-1).default()
    tilt: float = Quantity("rad", "tilt of the piston, front towards the upper wall", nominal=1e-3).default()
    tilt_rate: float = Quantity("rad/s", "rate of tilt").default()
    closed: Vector = kinds.SWITCH("corner in lasting contact with its wall", size="corners").per_element()
    impact_count: Vector = kinds.COUNT("impacts of a corner", size="corners").per_element()
    impact_impulse: Vector = kinds.IMPULSE(
        "sum of the normal impulses on a corner", size="corners"
    ).per_element()
    force_integral: Vector = kinds.IMPULSE(
        "time integral of the lasting wall force on a corner", size="corners"
    ).per_element()
    last_impact_time: float = Quantity("s", "time of the last impact").default()
    last_impact_velocity: float = kinds.VELOCITY(
        "velocity towards the wall just before the last impact", nominal=0.1
    ).default()
    event_count: float = kinds.COUNT("impacts and releases").default()
    last_event_time: float = Quantity("s", "time of the last impact or release").default()
    impact_loss: float = Quantity("J", "energy lost in impacts").default()


@dataclass
class PistonCrankState(PistonState):
    crank_impact_impulse: CrankImpulse = 0.0
    impact_work: float = Quantity("J", "energy given in impacts by the crank").default()


@dataclass
class FreePistonCrankState(PistonState):
    crank_angle: CrankAngle = 0.0
    crank_speed: CrankSpeed = 0.0


@dataclass
class PistonCrankInputs:
    crank_angle: CrankAngle = 0.0
    crank_speed: CrankSpeed = 0.0
    crank_acceleration: CrankAcceleration = 0.0
    gas_pressure: GasPressure = 0.0


@dataclass
class FreePistonCrankInputs:
    crank_drive: float = kinds.TORQUE("torque that drives the crank").default()
    gas_pressure: GasPressure = 0.0


@dataclass
class PistonOutputs:
    piston_position: float = Quantity(
        "m", "the skirt's middle from the shaft, along the cylinder", nominal=0.1
    ).default()
    piston_velocity: float = kinds.VELOCITY("its velocity along the cylinder").default()
    piston_offset: float = kinds.GAP("the skirt's middle above the cylinder's axis").default()
    piston_offset_rate: float = kinds.VELOCITY("its velocity across", nominal=0.1).default()
    piston_tilt: float = Quantity(
        "rad", "tilt of the piston, front towards the upper wall", nominal=1e-3
    ).default()
    piston_tilt_rate: float = Quantity("rad/s", "rate of the tilt").default()
    rod_angle: float = Quantity("rad", "angle of the connecting rod, piston end below", nominal=0.1).default()
    upper_front_gap: float = kinds.GAP("gap of the upper front corner").default()
    upper_rear_gap: float = kinds.GAP("gap of the upper rear corner").default()
    lower_front_gap: float = kinds.GAP("gap of the lower front corner").default()
    lower_rear_gap: float = kinds.GAP("gap of the lower rear corner").default()
    upper_front_force: float = kinds.WALL_FORCE("lasting wall force on the upper front corner").default()
    upper_rear_force: float = kinds.WALL_FORCE("lasting wall force on the upper rear corner").default()
    lower_front_force: float = kinds.WALL_FORCE("lasting wall force on the lower front corner").default()
    lower_rear_force: float = kinds.WALL_FORCE("lasting wall force on the lower rear corner").default()
    wall_friction_force: float = kinds.SIDE_FORCE(
        "lasting friction of the walls on the piston, along"
    ).default()
    pin_force_along: float = kinds.WALL_FORCE(
        "force of the rod on the piston pin, along, between impacts"
    ).default()
    pin_force_across: float = kinds.WALL_FORCE(
        "force of the rod on the piston pin, across, between impacts"
    ).default()
    upper_wall_impulse: float = kinds.IMPULSE(
        "upper wall's impulses and integral of its forces: differences give means"
    ).default()
    lower_wall_impulse: float = kinds.IMPULSE(
        "lower wall's impulses and integral of its forces: differences give means"
    ).default()
    corner_impact_count: Vector = kinds.COUNT(
        "impacts of a corner (upper front, upper rear, lower front, lower rear)", size="corners"
    ).per_element()
    corner_impact_impulse: Vector = kinds.IMPULSE(
        "sum of the normal impulses on a corner", size="corners"
    ).per_element()
    impact_count: float = kinds.COUNT("impacts of all corners").default()
    last_impact_time: float = Quantity("s", "time of the last impact").default()
    last_impact_velocity: float = kinds.VELOCITY(
        "velocity towards the wall just before the last impact", nominal=0.1
    ).default()
    event_count: float = kinds.COUNT("impacts and releases").default()
    last_event_time: float = Quantity("s", "time of the last impact or release").default()
    friction_power: float = Quantity(
        "W", "power taken by friction at pins and walls, between impacts", nominal=100.0
    ).default()
    impact_loss: float = Quantity("J", "energy lost in impacts").default()


@dataclass
class PistonCrankOutputs(PistonOutputs):
    crank_torque: float = kinds.TORQUE("torque taken from the crank, between impacts").default()
    crank_impact_impulse: CrankImpulse = 0.0


@dataclass
class FreePistonCrankOutputs(PistonOutputs):
    crank_angle: CrankAngle = 0.0
    crank_speed: CrankSpeed = 0.0
