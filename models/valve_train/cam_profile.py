"""Cycloidal cam with nose dwell, and the kinematics of its flat follower.

Kushwaha et al. 2000 (K), equation (31) and section 4.6; the entraining velocity with the speed that K's
own formula lacks. Angles in rad; a prime is d/d(cam angle). The nose is at pi.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..compile.kernel import kernel
from ..core.quantities import Vector
from ..core.requirements import Requirement

# Nearer to a break of the profile than this (rad) a cam has reached it: s'' changes there by 4e-9 of its
# largest value, and what that adds up to is below the 1e-10 of any integrator here.
REACHED = 1e-9


class Breaks(NamedTuple):
    """Cam angles (rad, > 0) to the next break of the profile forwards, and to the next one backwards."""

    ahead: float
    behind: float


class Lift(NamedTuple):
    """Lift s (m) and its derivatives s' (m/rad), s'' (m/rad^2) by the cam angle."""

    s: float
    ds: float
    dds: float


@kernel
def cycloidal_lift(angle: float, lift: float, rise_angle: float, dwell_half_width: float) -> Lift:
    """Rise s = S [a/B - sin(2 pi a/B) / (2 pi)] (K 31), dwell about the nose, mirrored fall.

    `angle` may be any real number; the event is centred on the nose at pi (modulo 2 pi).
    """
    from_nose = angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi)) - math.pi
    side = 1.0 if from_nose < 0.0 else -1.0
    a = rise_angle - (abs(from_nose) - dwell_half_width)
    if a >= rise_angle:
        return Lift(lift, 0.0, 0.0)
    if a <= 0.0:
        return Lift(0.0, 0.0, 0.0)
    w = 2.0 * math.pi / rise_angle
    return Lift(
        lift * (a / rise_angle - math.sin(w * a) / (2.0 * math.pi)),
        side * lift / rise_angle * (1.0 - math.cos(w * a)),
        lift / rise_angle * w * math.sin(w * a),
    )


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


@kernel
def smallest_radius_of_curvature(
    base_radius: float, lift: float, rise_angle: float, dwell_half_width: float
) -> float:
    """The least rho on the rise, from 2000 points (its error is of the order of lift * 1e-6)."""
    smallest = math.inf
    for i in range(2001):
        angle = math.pi - dwell_half_width - rise_angle * i / 2000.0
        cam = cycloidal_lift(angle, lift, rise_angle, dwell_half_width)
        smallest = min(smallest, radius_of_curvature(base_radius, cam))
    return smallest


@kernel
def event_fits(p: Any, told: Vector) -> bool:
    """Rise, dwell and fall within a turn."""
    told[0] = math.degrees(2.0 * (p.rise_angle + p.dwell_half_width))
    return p.rise_angle + p.dwell_half_width <= math.pi


@kernel
def is_convex(p: Any, told: Vector) -> bool:
    """As a flat follower needs it; of an event that fits."""
    if p.rise_angle + p.dwell_half_width > math.pi:
        return True
    smallest = smallest_radius_of_curvature(p.base_radius, p.lift, p.rise_angle, p.dwell_half_width)
    told[0] = 1e3 * smallest
    return smallest > 0.0


# Of a record with the profile's parameters.
PROFILE_REQUIREMENTS = (
    Requirement(event_fits, "2 (rise_angle + dwell_half_width) = {0:g} deg: must be at most 360 deg"),
    Requirement(
        is_convex,
        "smallest radius of curvature = {0:.3f} mm: must be > 0 for a flat follower (undercut); increase "
        "base_radius or rise_angle, or reduce lift",
    ),
)


@kernel
def breaks_about(angle: float, rise_angle: float, dwell_half_width: float) -> Breaks:
    """Where s''' jumps: at both ends of rise, dwell and fall. One that is nearer than REACHED is passed."""
    turn = 2.0 * math.pi
    ahead = behind = math.inf
    for i in range(4):
        half = dwell_half_width if i < 2 else dwell_half_width + rise_angle
        distance = math.pi + (half if i % 2 == 0 else -half) - angle
        forwards = distance - turn * math.floor(distance / turn)
        backwards = turn - forwards
        ahead = min(ahead, forwards if forwards > REACHED else forwards + turn)
        behind = min(behind, backwards if backwards > REACHED else backwards + turn)
    return Breaks(ahead, behind)


@kernel
def time_to_turn(angle: float, speed: float, acceleration: float) -> float:
    """The first time > 0 at which speed t + acceleration t^2/2 = angle, for angle > 0; infinite if never."""
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
