"""The shape of a cam from the lift of any follower, and the lift of another follower on that shape.

A shape is a curve in the cam's own frame. The cam turns anticlockwise, so that a flat follower touches the
normal at phi, clockwise from y, at the cam angle phi. A prime is d/d(cam angle), q the coordinate of a
follower.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ...core.quantities import Vector
from ..cams.lift import Lift
from ..cams.table import TURN, Points
from .arc import CamContact
from .mechanisms import Finger, Flat, Translating, touch_finger, touch_flat, touch_translating

LiftLaw = Callable[[float], Lift]


class Follower(NamedTuple):
    """A kind of follower.

    `geometry` is its record; `touch(lift, geometry)` is its contact; `follow(shape, geometry)` its lift on a
    shape. A rolling one has the cam's surface velocity.
    """

    description: str
    geometry: type
    touch: Callable[[Lift, Any], CamContact]
    follow: Callable[[CamShape, Any], Points]
    rolling: bool = False


@dataclass(frozen=True)
class CamShape:
    """Contour (m) with its unit normals and its radii of curvature (m, negative where hollow)."""

    x: Vector
    y: Vector
    normal_x: Vector
    normal_y: Vector
    radius: Vector


def trace_shape(angles: Vector, lift: LiftLaw, follower: Follower, geometry: Any) -> CamShape:
    """The shape that lifts this follower so, at these cam angles (rad)."""
    contacts = [follower.touch(lift(a), geometry) for a in angles]
    x, y, n_x, n_y, _, radius, *_ = np.array(contacts).T
    return CamShape(*_turn(x, y, -angles), *_turn(n_x, n_y, -angles), radius)


def find_least_radius(radius: Vector, cam_rate: Vector) -> int:
    """The row of the least radius of curvature: of hollows none counts, of places where the cam undercuts,
    cam_rate <= 0, the negative one."""
    return int(np.argmin(np.where((radius > 0.0) | (cam_rate <= 0.0), radius, np.inf)))


def follow_flat(shape: CamShape, g: Flat) -> Points:
    """p = point . normal, p' along the tangent, p'' = rho - p, at the angle of the normal less the tilt."""
    angle = np.unwrap(np.arctan2(shape.normal_x, shape.normal_y)) - g.tilt
    _check_progress(angle, shape, math.inf)
    p = shape.x * shape.normal_x + shape.y * shape.normal_y
    slope = shape.x * shape.normal_y - shape.y * shape.normal_x
    part = math.cos(g.tilt)
    return _order(angle, ((p - g.base_radius) / part, slope / part, (shape.radius - p) / part))


class Pose(NamedTuple):
    """Cam angles and coordinates q of a follower, with its centre's dC/dq and d2C/dq2."""

    angle: Vector
    q: Vector
    rate_x: Vector
    rate_y: Vector
    bend_x: Vector
    bend_y: Vector


class Path(NamedTuple):
    """How a follower moves: radius of its arc, its pose from the centre in the cam's frame, its lift of q."""

    radius: float
    pose: Callable[[Vector, Vector], Pose]
    lift: Callable[[Vector, Vector, Vector], tuple[Vector, Vector, Vector]]


def follow_translating(shape: CamShape, g: Translating) -> Points:
    """q = Y; the lift is what Y is above its rest."""
    rest = math.sqrt((g.base_radius + g.radius) ** 2 - g.offset**2)

    def pose(x: Vector, y: Vector) -> Pose:
        height = np.sqrt(x * x + y * y - g.offset**2)
        zero = np.zeros_like(x)
        return Pose(np.arctan2(height, g.offset) - np.arctan2(y, x), height, zero, zero + 1.0, zero, zero)

    return _follow_arc(shape, Path(g.radius, pose, lambda q, dq, ddq: (q - rest, dq, ddq)))


def follow_finger(shape: CamShape, g: Finger) -> Points:
    """q = rotation; the lift is the valve's, which is closed at q = 0."""
    pivot_x = -g.cam_arm * math.cos(g.pivot_angle)
    pivot_y = g.base_radius + g.radius + g.cam_arm * math.sin(g.pivot_angle)
    distance, closed = math.hypot(pivot_x, pivot_y), g.pivot_angle + g.valve_angle

    def pose(x: Vector, y: Vector) -> Pose:
        away = np.hypot(x, y)
        cosine = (away**2 + distance**2 - g.cam_arm**2) / (2.0 * away * distance)
        side = math.copysign(1.0, g.cam_arm)
        direction = math.atan2(pivot_y, pivot_x) - side * np.arccos(cosine)
        from_x, from_y = away * np.cos(direction) - pivot_x, away * np.sin(direction) - pivot_y
        turned = np.arctan2(side * from_y, side * from_x) + g.pivot_angle
        return Pose(direction - np.arctan2(y, x), turned, -from_y, from_x, -from_x, -from_y)

    def lift(q: Vector, dq: Vector, ddq: Vector) -> tuple[Vector, Vector, Vector]:
        sine, cosine = np.sin(q - closed), np.cos(q - closed)
        return (
            g.valve_arm * (sine + math.sin(closed)),
            g.valve_arm * cosine * dq,
            g.valve_arm * (cosine * ddq - sine * dq * dq),
        )

    return _follow_arc(shape, Path(g.radius, pose, lift))


def _follow_arc(shape: CamShape, path: Path) -> Points:
    """The lift of an arc on the cam, at the cam angles at which it touches the shape's points.

    The normal is perpendicular to the centre's motion in the cam's frame, n . (q' C_q - z x C) = 0, which
    gives q'; its derivative gives q'', with the normal's turn by the curvature. ValueError, with the angle,
    where the follower does not touch all points one after the other: the arc is larger than a hollow, or the
    cam undercut.
    """
    centre_x, centre_y = shape.x + path.radius * shape.normal_x, shape.y + path.radius * shape.normal_y
    pose = path.pose(centre_x, centre_y)
    x, y = _turn(centre_x, centre_y, pose.angle)
    n_x, n_y = _turn(shape.normal_x, shape.normal_y, pose.angle)
    along = n_x * pose.rate_x + n_y * pose.rate_y
    dq = (n_y * x - n_x * y) / along
    v_x, v_y = dq * pose.rate_x + y, dq * pose.rate_y - x
    tangent = n_y * v_x - n_x * v_y
    turn = tangent / (shape.radius + path.radius) - 1.0
    bend_x, bend_y = dq**2 * pose.bend_x + dq * pose.rate_y, dq**2 * pose.bend_y - dq * pose.rate_x
    ddq = -(turn * tangent + n_x * bend_x + n_y * bend_y) / along
    angle = np.unwrap(pose.angle)
    _check_progress(angle, shape, path.radius)
    return _order(angle, path.lift(pose.q, dq, ddq))


def sample_angles(count: int, breaks: Sequence[float] = ()) -> Vector:
    """Equally spaced cam angles (rad) over a turn, and these breaks of a profile among them."""
    even = TURN * np.arange(count) / count
    wanted = np.array([b % TURN for b in breaks])
    far = [a for a in even if not wanted.size or np.abs(wanted - a).min() > 1e-3 * TURN / count]
    return np.unique(np.concatenate([far, wanted]))


def _turn(x: Vector, y: Vector, angle: Vector) -> tuple[Vector, Vector]:
    """Vectors turned anticlockwise by these angles."""
    c, s = np.cos(angle), np.sin(angle)
    return c * x - s * y, s * x + c * y


def _check_progress(angle: Vector, shape: CamShape, radius: float) -> None:
    """A hollow of the cam must be wider than the arc, and contacts must follow one another."""
    narrow = (shape.radius <= 0.0) & (shape.radius + radius >= 0.0)
    wrong = np.flatnonzero(narrow[:-1] | ~(np.diff(angle) > 0.0))
    if wrong.size:
        degrees, curved = math.degrees(angle[wrong[0]]), 1e3 * shape.radius[wrong[0]]
        raise ValueError(
            f"the follower cannot touch the cam at {degrees:.1f} deg, where the cam's radius of curvature is "
            f"{curved:.3g} mm; take a smaller roller or pad, or a larger base circle"
        )


def _order(angle: Vector, lift: tuple[Vector, Vector, Vector]) -> Points:
    """From the smallest angle in [0, 2 pi)."""
    within = angle % TURN
    order: Any = np.argsort(within)
    return Points(within[order], *(column[order] for column in lift))


FOLLOWERS: dict[str, Follower] = {
    "flat": Follower("flat tappet or bucket", Flat, touch_flat, follow_flat),
    "roller": Follower(
        "translating roller", Translating, touch_translating, follow_translating, rolling=True
    ),
    "pad": Follower("translating pad of circular arc", Translating, touch_translating, follow_translating),
    "finger_roller": Follower("roller on a finger", Finger, touch_finger, follow_finger, rolling=True),
    "finger_pad": Follower("pad on a finger", Finger, touch_finger, follow_finger),
}
