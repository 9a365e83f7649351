"""Parameters, states, inputs and outputs of the slider-crank with a tilting piston."""

import math
from dataclasses import dataclass

from ... import kinds
from ...core.quantities import Condition, Quantity, Vector
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

_BORE = 0.086


@dataclass
class DrivenParameters:
    """Defaults: a petrol engine of 0.5 l a cylinder, chosen here: bore and stroke 86 mm, rod 3.3 crank
    radii long (Heywood 1988, 2.2: 3 to 4), the rest as is usual for that size. The crank's own mass is
    left to the flywheel that drives it."""

    crank_radius: CrankRadius = 0.5 * _BORE
    rod_length: RodLength = 0.143
    crank_mass: float = kinds.MASS("mass of the crank", minimum=0.0, only=Condition(("crank_centre",)))
    crank_centre: float = kinds.PLACE(
        "distance of the crank's centre of mass from the shaft",
        display_unit="mm",
        only=Condition(("crank_mass",)),
    )
    crank_inertia: float = kinds.ROD_INERTIA("inertia of the crank about its centre of mass")
    rod_mass: float = kinds.PART_MASS("mass of the connecting rod", 0.55, minimum=0.0)
    rod_centre: float = kinds.PLACE(
        "distance of the rod's centre of mass from the crank pin", 0.042, minimum=0.0, display_unit="mm"
    )
    rod_inertia: float = kinds.ROD_INERTIA("inertia of the rod about its centre of mass", 2.0e-3)
    piston_mass: float = kinds.PART_MASS("mass of the piston with its pin", 0.42, positive=True)
    piston_inertia: float = kinds.INERTIA("inertia of the piston about its centre of mass", 3.5e-4)
    half_length: float = kinds.PLACE(
        "half the length of the skirt; 0: a roller, which touches each wall at one point",
        0.025,
        minimum=0.0,
        display_unit="mm",
        plausible=PART_LENGTH,
    )
    half_height: float = kinds.PLACE(
        "half the width of the piston across the bore",
        0.5 * _BORE,
        minimum=0.0,
        display_unit="mm",
        plausible=PART_LENGTH,
    )
    clearance: float = kinds.GAP(
        "play of the middle piston to either wall", 40e-6, minimum=1e-7, plausible=PLAY
    )
    pin_height: float = kinds.DISTANCE("pin ahead of the skirt's middle, along", 4e-3, plausible=OFFSET)
    pin_offset: float = kinds.OFFSET("pin above the piston's middle line (to the upper wall)")
    mass_height: float = kinds.DISTANCE(
        "centre of mass ahead of the skirt's middle, along", 8e-3, plausible=OFFSET
    )
    mass_offset: float = kinds.OFFSET("centre of mass above the piston's middle line")
    crank_pin_friction: float = kinds.TURNING_DAMPING(
        "friction moment of the crank pin per relative speed", 1e-2, nominal=1e-2
    )
    piston_pin_friction: float = kinds.TURNING_DAMPING(
        "friction moment of the piston pin per relative speed", 2e-3, nominal=1e-2
    )
    wall_friction: float = kinds.NUMBER(
        "coefficient of Coulomb friction mu at the walls", 0.05, minimum=0.0, maximum=1.0
    )
    # A piston passes 1 mm/s within a microsecond of its dead centre, so that this rounding off moves
    # nothing visible, and a piston at rest creeps instead of sticking.
    creep_velocity: float = kinds.VELOCITY(
        "sliding velocity below which lasting friction falls to zero (as tanh)",
        1e-3,
        nominal=1e-3,
        positive=True,
    )
    restitution: float = kinds.NUMBER(
        "coefficient of restitution e normal to the walls", 0.3, minimum=0.0, maximum=1.0
    )
    # Bounces of rebound v under a pressing acceleration a end after another 2 v / ((1 - e) a). Ended
    # early, the piston misses excursions of v^2/(2 a), at most a (1 - e)^2 time^2 / 8 (some 1e-12 m
    # here), and keeps its momentum: an impact gives at once what the bounces would have given.
    chatter_time: float = kinds.TIME(
        "bounces that would end within this time end at once, in contact", 1e-7, nominal=1e-7, minimum=0.0
    )
    gravity_along: float = kinds.ACCELERATION(
        "gravity along the cylinder, + away from the crank", nominal=10.0
    )
    gravity_across: float = kinds.ACCELERATION(
        "gravity across the cylinder, + to the upper wall", nominal=10.0
    )
    bore_area: float = Quantity(
        "m2", "area that the gas pressure acts on", nominal=1e-2, minimum=0.0
    ).default(0.25 * math.pi * _BORE**2)


@dataclass
class FreeParameters(DrivenParameters):
    """As the other, with the inertia of a small flywheel on the crank."""

    crank_inertia: float = kinds.ROD_INERTIA("inertia of the crank about its centre of mass", 0.05)


@dataclass
class PistonState:
    """Corners in the order upper front, upper rear, lower front, lower rear; front is away from the crank."""

    offset: float = kinds.GAP("the piston's middle above the cylinder's axis")
    offset_rate: float = kinds.VELOCITY("rate of offset", nominal=1e-1)
    tilt: float = kinds.TILT("tilt of the piston, front towards the upper wall")
    tilt_rate: float = kinds.ROTATION_RATE("rate of tilt", nominal=1.0)
    closed: Vector = kinds.SWITCH.each("corner in lasting contact with its wall", "corners")
    impact_count: Vector = kinds.COUNT.each("impacts of a corner", "corners")
    impact_impulse: Vector = kinds.IMPULSE.each("sum of the normal impulses on a corner", "corners")
    force_integral: Vector = kinds.IMPULSE.each(
        "time integral of the lasting wall force on a corner", "corners"
    )
    last_impact_time: float = kinds.TIME("time of the last impact")
    last_impact_velocity: float = kinds.VELOCITY(
        "velocity towards the wall just before the last impact", nominal=0.1
    )
    event_count: float = kinds.COUNT("impacts and releases")
    last_event_time: float = kinds.TIME("time of the last impact or release")
    impact_loss: float = kinds.ENERGY("energy lost in impacts")


@dataclass
class DrivenState(PistonState):
    crank_impact_impulse: CrankImpulse = 0.0
    impact_work: float = kinds.ENERGY("energy given in impacts by the crank")


@dataclass
class FreeState(PistonState):
    crank_angle: CrankAngle = 0.0
    crank_speed: CrankSpeed = 0.0


@dataclass
class DrivenInputs:
    crank_angle: CrankAngle = 0.0
    crank_speed: CrankSpeed = 0.0
    crank_acceleration: CrankAcceleration = 0.0
    gas_pressure: GasPressure = 0.0


@dataclass
class FreeInputs:
    crank_drive: float = kinds.TORQUE("torque that drives the crank")
    gas_pressure: GasPressure = 0.0


@dataclass
class PistonOutputs:
    piston_position: float = kinds.PLACE("the skirt's middle from the shaft, along the cylinder")
    piston_velocity: float = kinds.VELOCITY("its velocity along the cylinder")
    piston_offset: float = kinds.GAP("the skirt's middle above the cylinder's axis")
    piston_offset_rate: float = kinds.VELOCITY("its velocity across", nominal=0.1)
    piston_tilt: float = kinds.TILT("tilt of the piston, front towards the upper wall")
    piston_tilt_rate: float = kinds.ROTATION_RATE("rate of the tilt", nominal=1.0)
    rod_angle: float = kinds.TILT("angle of the connecting rod, piston end below", nominal=0.1)
    upper_front_gap: float = kinds.GAP("gap of the upper front corner")
    upper_rear_gap: float = kinds.GAP("gap of the upper rear corner")
    lower_front_gap: float = kinds.GAP("gap of the lower front corner")
    lower_rear_gap: float = kinds.GAP("gap of the lower rear corner")
    upper_front_force: float = kinds.WALL_FORCE("lasting wall force on the upper front corner")
    upper_rear_force: float = kinds.WALL_FORCE("lasting wall force on the upper rear corner")
    lower_front_force: float = kinds.WALL_FORCE("lasting wall force on the lower front corner")
    lower_rear_force: float = kinds.WALL_FORCE("lasting wall force on the lower rear corner")
    wall_friction_force: float = kinds.SIDE_FORCE("lasting friction of the walls on the piston, along")
    pin_force_along: float = kinds.WALL_FORCE("force of the rod on the piston pin, along, between impacts")
    pin_force_across: float = kinds.WALL_FORCE("force of the rod on the piston pin, across, between impacts")
    upper_wall_impulse: float = kinds.IMPULSE(
        "upper wall's impulses and integral of its forces: differences give means"
    )
    lower_wall_impulse: float = kinds.IMPULSE(
        "lower wall's impulses and integral of its forces: differences give means"
    )
    corner_impact_count: Vector = kinds.COUNT.each(
        "impacts of a corner (upper front, upper rear, lower front, lower rear)", "corners"
    )
    corner_impact_impulse: Vector = kinds.IMPULSE.each("sum of the normal impulses on a corner", "corners")
    impact_count: float = kinds.COUNT("impacts of all corners")
    last_impact_time: float = kinds.TIME("time of the last impact")
    last_impact_velocity: float = kinds.VELOCITY(
        "velocity towards the wall just before the last impact", nominal=0.1
    )
    event_count: float = kinds.COUNT("impacts and releases")
    last_event_time: float = kinds.TIME("time of the last impact or release")
    friction_power: float = kinds.POWER(
        "power taken by friction at pins and walls, between impacts", nominal=100.0
    )
    impact_loss: float = kinds.ENERGY("energy lost in impacts")


@dataclass
class DrivenOutputs(PistonOutputs):
    crank_torque: float = kinds.TORQUE("torque taken from the crank, between impacts")
    crank_impact_impulse: CrankImpulse = 0.0


@dataclass
class FreeOutputs(PistonOutputs):
    crank_angle: CrankAngle = 0.0
    crank_speed: CrankSpeed = 0.0
