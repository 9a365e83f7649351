"""Finger: a lever with its pivot at one end, the valve at the other, and the cam in between, with its cam.

The pivot stands on the engine's head, elastically, or on a lash adjuster, and moves along the valve's path.
All positions count away from the cam, also those of valve and pivot.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import NO_EVENT, Component, PowerBond
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Vector, layouts
from ..core.requirements import Requirement, require
from .cams.choice import choose_profile
from .cams.lift import Lift
from .cams.profile import CamProfile, time_to_break
from .followers.arc import CamContact, touch_arc
from .followers.mechanisms import Finger, move_finger, touch_finger
from .followers.overlap import (
    CAM_BONDS,
    CAM_FEEDTHROUGH,
    CamInputs,
    CamOutputs,
    Centre,
    FollowerRadius,
    Overlap,
    Phase,
    find_overlap,
    require_contact,
    show_cam,
)
from .followers.tip import (
    TIP_BONDS,
    LeverMotion,
    Tip,
    TipInputs,
    TipOutputs,
    TipParameters,
    place_tip,
    show_tip,
)


@dataclass
class LeverParameters(TipParameters):
    """Defaults: a finger of 28 and 40 mm with a pad. The lift of the profile is the valve's."""

    phase: Phase = 0.0
    rolls: float = kinds.SWITCH("a roller on the cam; false: a pad, which slides")
    follower_radius: FollowerRadius = 20e-3
    cam_arm: float = kinds.ARM(
        "distance from the pivot to the centre of roller or pad; the cam's surface moves towards it, "
        "away from it where this is negative",
        28e-3,
    )
    pivot_angle: float = kinds.LEVER_ANGLE("angle by which that line falls, valve closed", math.radians(8.0))
    valve_arm: float = kinds.ARM(
        "distance from the pivot to the centre of the pad on the valve; the sign of cam_arm", 40e-3
    )
    valve_angle: float = kinds.LEVER_ANGLE("angle by which that line falls further", math.radians(2.0))
    mass: float = kinds.PART_MASS("mass of the finger", 0.05, nominal=0.1, positive=True)
    inertia: float = kinds.INERTIA("moment of inertia about the pivot", 3e-5, nominal=1e-5)
    mass_arm: float = kinds.DISTANCE(
        "distance from the pivot to the centre of mass, on the line to roller or pad", 18e-3
    )
    pivot_stiffness: float = kinds.SEAT_STIFFNESS(
        "stiffness of the pivot's support; 0: a lash adjuster bears it", nominal=1e8, minimum=0.0
    )
    pivot_damping: float = kinds.DAMPING("damping of the pivot's support", nominal=1e2)


@dataclass
class FingerState(LeverMotion):
    pivot_position: float = kinds.DEFLECTION("position of the pivot away from the cam")
    pivot_velocity: float = kinds.VELOCITY("velocity of the pivot", nominal=1e-2)


@dataclass
class FingerInputs(CamInputs, TipInputs):
    pivot_force: float = kinds.FORCE("force of a lash adjuster on the pivot, towards the cam")
    pivot_torque: float = kinds.FRICTION_TORQUE("torque of the pivot's friction against the rotation")
    roller_torque: float = kinds.FRICTION_TORQUE("torque of a roller that may slip, against the rotation")


@dataclass
class FingerOutputs(FingerState, CamOutputs, TipOutputs):
    ratio: float = kinds.NUMBER("load on the cam over that on the valve, slowly turned", 1.0)
    support_force: float = kinds.FORCE("force of the pivot on its support")


class Arm(NamedTuple):
    """From the pivot to the centre of roller or pad (m), and that centre as the cam asks for it."""

    x: float
    y: float
    wished_x: float
    wished_y: float


class Lever(NamedTuple):
    """What the state and the cam say of a finger."""

    contact: CamContact
    arm: Arm
    overlap: Overlap
    tip: Tip


class Forces(NamedTuple):
    """Accelerations of rotation (rad/s2) and pivot (m/s2), and the force on the pivot's support (N)."""

    rotation: float
    pivot: float
    support: float


@kernel
def lever_geometry(p: Any) -> Finger:
    return Finger(p.base_radius, p.follower_radius, p.cam_arm, p.pivot_angle, p.valve_arm, p.valve_angle)


@kernel
def touch(cam: Lift, p: Any) -> CamContact:
    """The contact at this lift of the valve."""
    return touch_finger(cam, lever_geometry(p))


@kernel
def place_lever(cam: Lift, x: FingerState, u: FingerInputs, p: Any) -> Lever:
    """Origin: the cam's axis. Closed, the centre is at (0, R0 + r)."""
    wished = move_finger(cam, lever_geometry(p))
    k = touch_arc(wished, p.follower_radius)
    angle = x.rotation - p.pivot_angle
    arm_x, arm_y = p.cam_arm * math.cos(angle), p.cam_arm * math.sin(angle)
    pivot_x = -p.cam_arm * math.cos(p.pivot_angle)
    pivot_y = p.base_radius + p.follower_radius + p.cam_arm * math.sin(p.pivot_angle) + x.pivot_position
    rate = x.rotation_rate
    centre = Centre(
        pivot_x + arm_x,
        pivot_y + arm_y,
        -arm_y * rate,
        arm_x * rate + x.pivot_velocity,
        -(k.y - pivot_y) * rate,
        (k.x - pivot_x) * rate + x.pivot_velocity,
    )
    overlap = find_overlap(k, wished.x, wished.y, centre, u)
    tip = place_tip(x.rotation, p.valve_arm, p.pivot_angle + p.valve_angle, p.tip_radius)
    return Lever(k, Arm(arm_x, arm_y, k.x - pivot_x, k.y - pivot_y), overlap, tip)


@kernel
def accelerate(lever: Lever, x: FingerState, u: FingerInputs, p: Any) -> Forces:
    """J b'' + S cos(d) y'' = moment, m y'' + S cos(d) b'' - S sin(d) b'^2 = force, with S = m e.

    The friction F acts on roller or pad along t = (-n_y, n_x), at the contact.
    """
    k, arm, tip = lever.contact, lever.arm, lever.tip
    support = p.pivot_stiffness * x.pivot_position + p.pivot_damping * x.pivot_velocity + u.pivot_force
    moment = u.cam_load * (arm.x * k.normal_y - arm.y * k.normal_x)
    force = u.cam_load * k.normal_y - support - u.tip_load
    moment -= u.tip_load * tip.by_rotation + u.tip_friction * tip.sliding
    moment -= u.pivot_torque + u.roller_torque
    if p.rolls == 0.0:
        moment += u.cam_friction * (arm.wished_x * k.normal_x + arm.wished_y * k.normal_y)
        force += u.cam_friction * k.normal_x
    angle = x.rotation - p.pivot_angle
    static = p.mass * p.mass_arm
    coupling = static * math.cos(angle)
    force += static * math.sin(angle) * x.rotation_rate**2
    determinant = p.inertia * p.mass - coupling * coupling
    return Forces(
        (p.mass * moment - coupling * force) / determinant,
        (p.inertia * force - coupling * moment) / determinant,
        support,
    )


@kernel
def energy(t: float, x: FingerState, u: FingerInputs, p: Any, e: Vector) -> None:
    coupling = p.mass * p.mass_arm * math.cos(x.rotation - p.pivot_angle)
    e[0] = 0.5 * (
        p.inertia * x.rotation_rate**2
        + p.mass * x.pivot_velocity**2
        + 2.0 * coupling * x.rotation_rate * x.pivot_velocity
        + p.pivot_stiffness * x.pivot_position**2
    )
    e[1] = p.pivot_damping * x.pivot_velocity**2
    e[2] = 0.0


@require("inertia = {0:g} kg.m2: must be > mass mass_arm^2 = {1:g} kg.m2, which the centre of mass alone has")
def inertia_is_of_its_mass(p: Any, numbers: Vector) -> bool:
    numbers[0], numbers[1] = p.inertia, p.mass * p.mass_arm**2
    return p.inertia > p.mass * p.mass_arm**2


@require("cam_arm = {0:g} mm, valve_arm = {1:g} mm: must not be zero and must have one sign")
def arms_have_one_side(p: Any, numbers: Vector) -> bool:
    numbers[0], numbers[1] = 1e3 * p.cam_arm, 1e3 * p.valve_arm
    return p.cam_arm * p.valve_arm > 0.0


def require_reach(profile: CamProfile) -> Requirement:
    """The finger can lift the valve as far as the profile asks; 360 cam angles are looked at."""
    lift = profile.lift

    @require(
        "valve_arm = {0:g} mm: the finger cannot lift the valve by {1:g} mm, at the cam angle {2:.0f} deg; "
        "make it longer"
    )
    def reaches(p: Any, numbers: Vector) -> bool:
        rest = math.sin(p.pivot_angle + p.valve_angle)
        for i in range(360):
            lifted = lift(math.pi * i / 180.0, p).s
            numbers[0], numbers[1], numbers[2] = 1e3 * p.valve_arm, 1e3 * lifted, float(i)
            if p.valve_arm != 0.0 and not abs(lifted / p.valve_arm - rest) < 1.0:
                return False
        return True

    return reaches


def make_motion(profile: CamProfile) -> tuple[Any, Any]:
    """The kernels `derivative` and `output` of a finger on a cam with this profile."""
    lift, find_breaks = profile.lift, profile.find_breaks

    @kernel
    def derivative(t: float, x: FingerState, u: FingerInputs, p: Any, dx: FingerState) -> None:
        lever = place_lever(lift(u.cam_angle + p.phase, p), x, u, p)
        forces = accelerate(lever, x, u, p)
        dx.rotation, dx.rotation_rate = x.rotation_rate, forces.rotation
        dx.pivot_position, dx.pivot_velocity = x.pivot_velocity, forces.pivot

    @kernel
    def output(t: float, x: FingerState, u: FingerInputs, p: Any, y: FingerOutputs) -> None:
        angle = u.cam_angle + p.phase
        cam = lift(angle, p)
        lever = place_lever(cam, x, u, p)
        k, arm = lever.contact, lever.arm
        show_cam(k, lever.overlap, 1.0 / p.follower_radius, p.rolls != 0.0, u, y)
        show_tip(lever.tip, x.rotation_rate, x.pivot_position, x.pivot_velocity, p, y)
        y.rotation, y.rotation_rate = x.rotation, x.rotation_rate
        y.pivot_position, y.pivot_velocity = x.pivot_position, x.pivot_velocity
        y.ratio = lever.tip.by_rotation / (arm.x * k.normal_y - arm.y * k.normal_x)
        y.support_force = accelerate(lever, x, u, p).support
        y.contact_offset = -p.follower_radius * (y.pressure_angle + x.rotation)
        y.profile_angle = angle
        y.cam_lift = cam.s
        y.next_event = min(t + time_to_break(find_breaks(angle, p), u.cam_speed, 0.0), NO_EVENT)

    return derivative, output


def finger(table_points: int = 0) -> Component:
    """A finger on a cam by a law, or through `table_points` points."""
    profile, parameters = choose_profile(table_points, LeverParameters)
    sizes = {"table_points": table_points}
    derivative, output = make_motion(profile)
    return Component(
        tolerance=FINE_TOLERANCE,
        name="finger",
        description="Lever on an end pivot, with a roller or pad on its cam",
        roles=(roles.Cam(), roles.PivotedFollower()),
        **layouts(parameters, FingerState, FingerInputs, FingerOutputs, sizes),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={**CAM_FEEDTHROUGH, "ratio": ("cam_angle",), "support_force": ("pivot_force",)},
        bonds=(
            *CAM_BONDS,
            *TIP_BONDS,
            PowerBond("pivot_force", "pivot_velocity", -1),
            PowerBond("pivot_torque", "rotation_rate", -1),
            PowerBond("roller_torque", "rotation_rate", -1),
        ),
        requirements=(
            inertia_is_of_its_mass,
            arms_have_one_side,
            *profile.requirements,
            require_reach(profile),
            require_contact(profile, touch),
        ),
        structure=sizes,
        event_indicators=("entraining_velocity", "tip_entraining_velocity"),
        next_event="next_event",
    )
