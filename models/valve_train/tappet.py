"""Tappet: a cam and the follower that it moves along a line, flat, roller or pad.

The follower is a body of its own, so that a pushrod, a lash adjuster or a valve may stand on it. The contact
with the cam is another component, which takes the overlap and gives the load back.
"""

from dataclasses import dataclass
from typing import Any

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import NO_EVENT, Component, PowerBond
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Condition, Vector, layouts
from ..core.requirements import require
from .cams.choice import choose_profile
from .cams.lift import Lift
from .cams.profile import CamProfile, time_to_break
from .followers.arc import CamContact
from .followers.mechanisms import Flat, Translating, touch_flat, touch_translating
from .followers.overlap import (
    CAM_BONDS,
    CAM_FEEDTHROUGH,
    FORCES,
    CamInputs,
    CamOutputs,
    Centre,
    Overlap,
    Phase,
    find_overlap,
    require_contact,
    show_cam,
)

FLAT, ROLLER, PAD = 0.0, 1.0, 2.0
IF_ROUND = Condition(("follower",), ("roller", "pad"))


@dataclass
class FollowerParameters:
    phase: Phase = 0.0
    follower: float = kinds.NUMBER("surface on the cam", FLAT, choices=("flat", "roller", "pad"))
    follower_radius: float = kinds.ARC("radius of roller or pad", 10e-3, only=IF_ROUND)
    offset: float = kinds.OFFSET(
        "offset of the path of roller or pad from the cam's axis, along axis_x", only=IF_ROUND
    )
    tilt: float = kinds.ANGLE(
        "tilt of a flat face: of its normal from the path towards axis_x",
        nominal=0.1,
        minimum=-1.0,
        maximum=1.0,
        only=Condition(("follower",), ("flat",)),
    )
    mass: float = kinds.PART_MASS("mass of the follower", 0.1, nominal=0.1, positive=True)
    guide_damping: float = kinds.DAMPING("viscous friction in the guide", nominal=10.0)
    gravity: float = kinds.GRAVITY.default()


@dataclass
class TappetState:
    position: float = kinds.DISPLACEMENT("position y, zero on the base circle")
    velocity: float = kinds.VELOCITY("velocity of the follower")


@dataclass
class TappetInputs(CamInputs):
    load: float = kinds.FORCE("force of the train on the follower")
    guide_friction: float = kinds.FRICTION("friction of the guide against the velocity")


@dataclass
class TappetOutputs(TappetState, CamOutputs):
    acceleration: float = kinds.ACCELERATION("acceleration of the follower")
    side_force: float = kinds.SIDE_FORCE("force of the follower on its guide along axis_x")
    side_moment: float = kinds.TORQUE(
        "moment of load and friction about the face, or the centre of roller or pad", nominal=1.0
    )


@kernel
def touch(cam: Lift, p: Any) -> CamContact:
    """The contact at this lift."""
    if p.follower == FLAT:
        return touch_flat(cam, Flat(p.base_radius, p.tilt))
    return touch_translating(cam, Translating(p.base_radius, p.follower_radius, p.offset))


@kernel
def overlap(k: CamContact, cam: Lift, x: TappetState, u: TappetInputs) -> Overlap:
    """The centre is at the position y; the cam asks for the lift s."""
    return find_overlap(k, 0.0, cam.s, Centre(0.0, x.position, 0.0, x.velocity, 0.0, x.velocity), u)


@kernel
def accelerate(k: CamContact, x: TappetState, u: TappetInputs, p: Any) -> float:
    """m y'' = W n_y - load - F_g - c y' - m g, and of a sliding follower the friction F t_y."""
    force = u.cam_load * k.normal_y - u.load - p.guide_damping * x.velocity - u.guide_friction
    if p.follower != ROLLER:
        force += u.cam_friction * k.normal_x
    return force / p.mass - p.gravity


@kernel
def energy(t: float, x: TappetState, u: TappetInputs, p: Any, e: Vector) -> None:
    e[0] = p.mass * (0.5 * x.velocity**2 + p.gravity * x.position)
    e[1] = p.guide_damping * x.velocity**2
    e[2] = 0.0


@require("offset = {0:g} mm: must be less than base_radius + follower_radius = {1:g} mm")
def path_is_near(p: Any, numbers: Vector) -> bool:
    numbers[0], numbers[1] = 1e3 * p.offset, 1e3 * (p.base_radius + p.follower_radius)
    return p.follower == FLAT or abs(p.offset) < p.base_radius + p.follower_radius


def make_motion(profile: CamProfile) -> tuple[Any, Any]:
    """The kernels `derivative` and `output` of a tappet on a cam with this profile."""
    lift, find_breaks = profile.lift, profile.find_breaks

    @kernel
    def derivative(t: float, x: TappetState, u: TappetInputs, p: Any, dx: TappetState) -> None:
        k = touch(lift(u.cam_angle + p.phase, p), p)
        dx.position = x.velocity
        dx.velocity = accelerate(k, x, u, p)

    @kernel
    def output(t: float, x: TappetState, u: TappetInputs, p: Any, y: TappetOutputs) -> None:
        angle = u.cam_angle + p.phase
        cam = lift(angle, p)
        k = touch(cam, p)
        curvature = 0.0 if p.follower == FLAT else 1.0 / p.follower_radius
        show_cam(k, overlap(k, cam, x, u), curvature, p.follower == ROLLER, u, y)
        y.position = x.position
        y.velocity = x.velocity
        y.acceleration = accelerate(k, x, u, p)
        y.side_force = u.cam_load * k.normal_x
        if p.follower != ROLLER:
            y.side_force -= u.cam_friction * k.normal_y
        along = k.arm + cam.s * k.normal_x
        y.side_moment = 0.0
        if p.follower == FLAT:
            y.side_moment = -along * u.cam_load / k.normal_y
        elif p.follower == PAD:
            y.side_moment = p.follower_radius * u.cam_friction
        y.contact_offset = along if p.follower == FLAT else -p.follower_radius * y.pressure_angle
        y.profile_angle = angle
        y.cam_lift = cam.s
        y.next_event = min(t + time_to_break(find_breaks(angle, p), u.cam_speed, 0.0), NO_EVENT)

    return derivative, output


def tappet(table_points: int = 0) -> Component:
    """A follower in its guide, on a cam by a law, or through `table_points` points."""
    profile, parameters = choose_profile(table_points, FollowerParameters)
    sizes = {"table_points": table_points}
    derivative, output = make_motion(profile)
    return Component(
        tolerance=FINE_TOLERANCE,
        name="tappet",
        description="Flat, roller or pad follower in its guide, with its cam",
        roles=(roles.Cam(), roles.TranslatingFollower()),
        **layouts(parameters, TappetState, TappetInputs, TappetOutputs, sizes),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            **CAM_FEEDTHROUGH,
            "acceleration": (*FORCES, "load", "guide_friction"),
            "side_force": FORCES,
            "side_moment": FORCES,
        },
        bonds=(
            *CAM_BONDS,
            PowerBond("load", "velocity", -1),
            PowerBond("guide_friction", "velocity", -1),
        ),
        requirements=(path_is_near, *profile.requirements, require_contact(profile, touch)),
        structure=sizes,
        # Where the entrainment reverses, film formulas have a kink: they know |u|.
        event_indicators=("entraining_velocity",),
        next_event="next_event",
    )
