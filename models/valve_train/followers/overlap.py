"""A cam that presses on its follower: how far both overlap, and what load and friction do to them.

The follower's arc (a flat one: its face) has its centre at C, the cam's shape asks it to be at C_w, and the
cam's axis is displaced by a. The overlap is d = n . (C_w + a - C) with the normal n of the contact. Load and
torque act along the gradients of d, so that no energy is lost between them. A prime is d/d(cam angle).
"""

import math
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from ... import kinds
from ...compile.kernel import kernel
from ...core.component import NO_EVENT, PowerBond
from ...core.quantities import Vector
from ...core.requirements import Requirement, require
from ..cams.profile import CamProfile
from .arc import CamContact

Phase = Annotated[float, kinds.PHASE.of("cam angle at shaft angle zero; the nose is at pi")]
FollowerRadius = Annotated[float, kinds.ARC.of("radius of roller or pad")]


@dataclass
class CamInputs:
    """What a follower feels of its cam. The cam's axis stays in place where its displacement is not given."""

    cam_angle: float = kinds.ANGLE("angle of the shaft at the cam")
    cam_speed: float = kinds.SPEED("speed of the shaft at the cam")
    axis_x: float = kinds.PLACE("displacement of the cam's axis across the follower's path", nominal=1e-4)
    axis_y: float = kinds.PLACE("displacement of the cam's axis towards the follower", nominal=1e-4)
    axis_velocity_x: float = kinds.VELOCITY("rate of axis_x", nominal=0.1)
    axis_velocity_y: float = kinds.VELOCITY("rate of axis_y", nominal=0.1)
    cam_load: float = kinds.FORCE("load W of the cam on the follower")
    cam_friction: float = kinds.FRICTION("friction on the cam against its sliding")
    rolling_friction: float = kinds.FRICTION(
        "rolling friction F_R of each surface, with the sign of the entraining velocity"
    )
    surface_speed: float = kinds.VELOCITY(
        "speed of a pad's surface along its body: of a roller that may slip"
    )


@dataclass
class CamOutputs:
    """What the contact and the shaft feel of a follower."""

    overlap: float = kinds.FILM("cam into follower along the normal")
    overlap_rate: float = kinds.VELOCITY("rate of the overlap", nominal=1e-2)
    entraining_velocity: float = kinds.VELOCITY("mean surface velocity relative to the contact")
    sliding_velocity: float = kinds.VELOCITY("velocity of cam over follower surface")
    rolling_velocity: float = kinds.VELOCITY(
        "surface_speed at which nothing would slide; 0 where nothing can"
    )
    rolling_speed: float = kinds.VELOCITY(
        "velocities of both surfaces past the contact, without that of a roller that may slip"
    )
    surface_velocity: float = kinds.VELOCITY("surface_speed of a pad; 0 for a roller without slip")
    radius_of_curvature: float = kinds.DISTANCE("reduced radius of cam and follower", 0.02)
    pressure_angle: float = kinds.ANGLE("angle of the contact's normal to the follower's path")
    cam_radius: float = kinds.DISTANCE("radius of the cam at the contact", 0.02)
    contact_offset: float = kinds.DISTANCE("place of the contact along the follower")
    profile_angle: float = kinds.ANGLE("angle of the cam at the contact; the nose is at pi")
    cam_torque: float = kinds.TORQUE("torque taken from the shaft")
    cam_force_x: float = kinds.FORCE("force on the cam's axis along axis_x")
    cam_force_y: float = kinds.FORCE("force on the cam's axis along axis_y")
    cam_lift: float = kinds.DISPLACEMENT("lift s of the profile")
    next_event: float = kinds.TIME(
        "time at which the cam next reaches a jump of s''' (jerk); 1e30 if it rests", NO_EVENT
    )


ANGLE = ("cam_angle",)
PLACE = ("cam_angle", "axis_x", "axis_y")
MOTION = (*PLACE, "cam_speed", "axis_velocity_x", "axis_velocity_y")
FORCES = (*PLACE, "cam_load", "cam_friction")
TORQUES = (*FORCES, "rolling_friction")

CAM_FEEDTHROUGH = {
    "overlap": PLACE,
    "overlap_rate": MOTION,
    "entraining_velocity": (*ANGLE, "cam_speed", "surface_speed"),
    "sliding_velocity": (*MOTION, "surface_speed"),
    "rolling_velocity": MOTION,
    "rolling_speed": (*ANGLE, "cam_speed"),
    "surface_velocity": ("surface_speed",),
    "radius_of_curvature": ANGLE,
    "pressure_angle": ANGLE,
    "cam_radius": ANGLE,
    "contact_offset": ANGLE,
    "profile_angle": ANGLE,
    "cam_torque": TORQUES,
    "cam_force_x": FORCES,
    "cam_force_y": FORCES,
    "cam_lift": ANGLE,
    "next_event": (*ANGLE, "cam_speed"),
}

CAM_BONDS = (
    PowerBond("cam_load", "overlap_rate", -1),
    PowerBond("cam_friction", "sliding_velocity", -1),
    PowerBond("cam_friction", "surface_velocity", -1),
    PowerBond("rolling_friction", "rolling_speed", -1),
    PowerBond("cam_torque", "cam_speed", +1),
    PowerBond("cam_force_x", "axis_velocity_x", -1),
    PowerBond("cam_force_y", "axis_velocity_y", -1),
)


class Centre(NamedTuple):
    """Centre (x, y) of a follower's arc (m), its velocity, and that of the follower at the contact (m/s)."""

    x: float
    y: float
    velocity_x: float
    velocity_y: float
    surface_velocity_x: float
    surface_velocity_y: float


class Overlap(NamedTuple):
    """The overlap (m), its derivatives by cam angle (m) and time (m/s), and the sliding velocity (m/s)."""

    value: float
    by_angle: float
    rate: float
    sliding: float


@kernel
def find_overlap(k: CamContact, wished_x: float, wished_y: float, c: Centre, u: Any) -> Overlap:
    """d = n . g with g = C_w + a - C; n' = normal_turn (n_y, -n_x). Sliding is along t = (-n_y, n_x)."""
    gap_x, gap_y = wished_x + u.axis_x - c.x, wished_y + u.axis_y - c.y
    by_angle = k.arm + k.normal_turn * (k.normal_y * gap_x - k.normal_x * gap_y)
    rate = by_angle * u.cam_speed
    rate += k.normal_x * (u.axis_velocity_x - c.velocity_x) + k.normal_y * (u.axis_velocity_y - c.velocity_y)
    sliding = u.cam_speed * (k.x * k.normal_x + k.y * k.normal_y)
    sliding -= k.normal_y * (u.axis_velocity_x - c.surface_velocity_x)
    sliding += k.normal_x * (u.axis_velocity_y - c.surface_velocity_y)
    return Overlap(k.normal_x * gap_x + k.normal_y * gap_y, by_angle, rate, sliding)


@kernel
def show_cam(k: CamContact, o: Overlap, arc_curvature: float, rolls: bool, u: Any, y: Any) -> None:
    """The outputs of a contact, but lift and event. A roller has the surface velocity of its cam."""
    y.overlap, y.overlap_rate = o.value, o.rate
    y.surface_velocity = 0.0 if rolls else u.surface_speed
    y.rolling_velocity = 0.0 if rolls else o.sliding
    y.sliding_velocity = y.rolling_velocity - y.surface_velocity
    follower_rate = k.cam_rate if rolls else k.follower_rate
    y.rolling_speed = u.cam_speed * (k.cam_rate + follower_rate)
    y.entraining_velocity = 0.5 * u.cam_speed * (k.cam_rate + follower_rate) + 0.5 * y.surface_velocity
    y.radius_of_curvature = 1.0 / (1.0 / k.radius + arc_curvature)
    y.pressure_angle = math.atan2(k.normal_x, k.normal_y)
    y.cam_radius = k.radius
    y.cam_torque = u.cam_load * o.by_angle + u.rolling_friction * (k.cam_rate + follower_rate)
    y.cam_force_x = -u.cam_load * k.normal_x
    y.cam_force_y = -u.cam_load * k.normal_y
    if not rolls:
        y.cam_torque += u.cam_friction * (k.x * k.normal_x + k.y * k.normal_y)
        y.cam_force_x += u.cam_friction * k.normal_y
        y.cam_force_y -= u.cam_friction * k.normal_x


def require_contact(profile: CamProfile, touch_at: Any) -> Requirement:
    """The follower touches every point of the cam, one after the other.

    `touch_at(lift, p)` is a kernel that gives the contact. 2000 cam angles are looked at.
    """
    lift = profile.lift

    @require(
        "base_radius: at the cam angle {0:.1f} deg the cam undercuts, its contour crosses itself; increase "
        "base_radius, or take a smaller radius of the follower or a profile with less |s''|"
    )
    def touches(p: Any, numbers: Vector) -> bool:
        for i in range(2000):
            angle = 2.0 * math.pi * i / 2000.0
            numbers[0] = math.degrees(angle)
            if not touch_at(lift(angle, p), p).cam_rate > 0.0:
                return False
        return True

    return touches
