"""What a cam shaft or a follower needs of a cam profile, and the kinematics of a flat follower on it.

Kushwaha et al. 2000 (K), section 4.6; the entraining velocity with the speed that K's own formula lacks.
Angles in rad; a prime is d/d(cam angle).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ...core.quantities import Vector
from ...core.requirements import Requirement, require
from .lift import Lift

# Nearer to a break of the profile than this (rad) a cam has reached it: s'' changes there by 4e-9 of its
# largest value, and what that adds up to is below the 1e-10 of any integrator here.
REACHED = 1e-9
# Points of a turn at which radii of curvature are looked at.
RADII = 4000


class Breaks(NamedTuple):
    """Cam angles (rad, > 0) to the next break of the profile forwards, and to the next one backwards."""

    ahead: float
    behind: float


@dataclass(frozen=True)
class CamProfile:
    """A kind of cam profile.

    `parameters` is the record class that describes one, with `base_radius` among its fields. Components take
    over its fields. Kernels take such a record p: `lift(angle, p)` is a Lift,
    for any real angle (rad); `find_breaks(angle, p)` are the Breaks, where s'' or
    s''' jumps.
    """

    parameters: type
    lift: Any
    find_breaks: Any
    requirements: Sequence[Requirement]


@kernel
def radius_of_curvature(base_radius: float, cam: Lift) -> float:
    """rho = R0 + s + s''."""
    return base_radius + cam.s + cam.dds


@kernel
def entraining_velocity(base_radius: float, cam: Lift, cam_speed: float) -> float:
    """u = omega (R0 + s + 2 s'') / 2: mean of both surface velocities relative to the contact."""
    return 0.5 * cam_speed * (base_radius + cam.s + 2.0 * cam.dds)


@kernel
def sliding_velocity(base_radius: float, cam: Lift, cam_speed: float) -> float:
    """omega (R0 + s): velocity of the cam's surface over the follower's."""
    return cam_speed * (base_radius + cam.s)


def find_smallest_radius(profile: CamProfile) -> Any:
    """A kernel (p) -> the least rho over a turn (m), from RADII points (its error is about 1e-5 S)."""
    lift = profile.lift

    @kernel
    def smallest_radius(p: Any) -> float:
        smallest = math.inf
        for i in range(RADII):
            cam = lift(2.0 * math.pi * i / RADII, p)
            smallest = min(smallest, radius_of_curvature(p.base_radius, cam))
        return smallest

    return smallest_radius


@kernel
def name_convex_base(base_radius: float, smallest: float) -> float:
    """Above this base circle radius (mm, rounded up) rho = R0 + s + s'' > 0 all around."""
    return 1e-3 * math.ceil(1e6 * (base_radius - smallest))


def require_convexity(profile: CamProfile) -> Requirement:
    """As a flat follower needs it."""
    smallest_radius = find_smallest_radius(profile)

    @require(
        "base_radius: the smallest radius of curvature is {0:.3f} mm; it must be > 0 for a flat follower "
        "(undercut); take base_radius > {1:.3f} mm, or a profile with less |s''|"
    )
    def is_convex(p: Any, numbers: Vector) -> bool:
        smallest = smallest_radius(p)
        numbers[0] = 1e3 * smallest
        numbers[1] = name_convex_base(p.base_radius, smallest)
        return smallest > 0.0

    return is_convex


@kernel
def turn_to_break(at: float, angle: float, breaks: Breaks) -> Breaks:
    """The breaks with one more, `at` a cam angle. One that is nearer than REACHED is passed."""
    turn = 2.0 * math.pi
    distance = at - angle
    forwards = distance - turn * math.floor(distance / turn)
    backwards = turn - forwards
    return Breaks(
        min(breaks.ahead, forwards if forwards > REACHED else forwards + turn),
        min(breaks.behind, backwards if backwards > REACHED else backwards + turn),
    )


@kernel
def time_to_turn(angle: float, speed: float, acceleration: float) -> float:
    """The first time > 0 at which speed t + acceleration t^2/2 = angle, for angle > 0; infinite if never."""
    if angle == math.inf:
        return math.inf
    square = speed * speed + 2.0 * acceleration * angle
    if square < 0.0:
        return math.inf
    root = math.sqrt(square)
    if speed >= 0.0:
        return 2.0 * angle / (speed + root) if speed + root > 0.0 else math.inf
    return (root - speed) / acceleration if acceleration > 0.0 else math.inf


@kernel
def time_to_break(breaks: Breaks, speed: float, acceleration: float) -> float:
    """Time (s) after which a cam that turns so reaches a break, in either direction; infinite if never."""
    return min(
        time_to_turn(breaks.ahead, speed, acceleration), time_to_turn(breaks.behind, -speed, -acceleration)
    )
