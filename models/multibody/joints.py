"""Joints: groups of scalar constraints between two bodies, i (named first) and j (named second).

Points and axes are given in the bodies' own axes, from their centres of mass; a body called "ground" is the
ground, whose axes are those of the global frame.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from ..core.errors import ModelError
from ..core.quantities import Vector
from .bodies import ORIGIN, Point, Y, Z, check_values, find_direction, make_axes
from .tables import AHEAD, DRIVEN, FLAT_CAM, LEVER, PAD, PERPENDICULAR

AXES = ("first axis", "second axis", "third axis")


@dataclass(frozen=True)
class Constraint:
    """One scalar constraint: what it holds, and its fields in the table of rows."""

    name: str
    fields: dict[str, Any]


@dataclass(frozen=True)
class Joint:
    """The constraints between two bodies, with the points at which reactions are told.

    Constraints hold for axes in opposite directions too: of `alike`, axes of i and of j, both point one way.
    """

    name: str
    i: str
    j: str
    constraints: Sequence[Constraint]
    at_i: Point = ORIGIN
    at_j: Point = ORIGIN
    cam: Any = None  # record of the cam's parameters
    alike: Sequence[tuple[Vector, Vector]] = ()


def hold_points(axes: Vector, names: Sequence[str], at_i: Point, at_j: Point) -> list[Constraint]:
    """P_j does not move against P_i along these axes of i."""
    return [
        Constraint(f"along {name}", {"kind": AHEAD, "a": axis, "p_i": at_i, "p_j": at_j})
        for axis, name in zip(axes, names, strict=True)
    ]


def hold_axes(pairs: Sequence[tuple[Point, Point]], names: Sequence[str]) -> list[Constraint]:
    """An axis of i stays perpendicular to one of j, for each pair."""
    return [
        Constraint(f"about {name}", {"kind": PERPENDICULAR, "a": a, "b": b})
        for (a, b), name in zip(pairs, names, strict=True)
    ]


def revolute(
    name: str,
    i: str,
    j: str,
    at_i: Point = ORIGIN,
    at_j: Point = ORIGIN,
    axis_i: Point = Z,
    axis_j: Point = Z,
    *,
    held: int = 3,
) -> Joint:
    """j turns about an axis, the third of i's; P_j is held along so many of them: 5 constraints."""
    a, b = make_axes(axis_i), make_axes(axis_j)
    points = hold_points(a[:held], AXES[:held], at_i, at_j)
    parallel = hold_axes([(a[0], b[2]), (a[1], b[2])], ("second axis", "first axis"))
    return Joint(name, i, j, [*points, *parallel], at_i, at_j, alike=[(a[2], b[2])])


# j turns about and slides along an axis: 4 constraints, K (12).
cylindrical = partial(revolute, held=2)


def support(name: str, i: str, j: str, at_i: Point = ORIGIN, at_j: Point = ORIGIN, axis: Point = Z) -> Joint:
    """A point of j stays on an axis of i, about which and across which it may turn: 2 constraints."""
    return Joint(name, i, j, hold_points(make_axes(axis)[:2], AXES[:2], at_i, at_j), at_i, at_j)


def spherical(name: str, i: str, j: str, at_i: Point = ORIGIN, at_j: Point = ORIGIN) -> Joint:
    """A point of j stays at a point of i: 3 constraints."""
    return Joint(name, i, j, hold_points(np.eye(3), ("x", "y", "z"), at_i, at_j), at_i, at_j)


def _hold_turn(a: Vector, b: Vector) -> list[Constraint]:
    """All axes are parallel."""
    return hold_axes([(a[1], b[2]), (a[2], b[0]), (a[0], b[1])], AXES)


def translational(
    name: str,
    i: str,
    j: str,
    at_i: Point = ORIGIN,
    at_j: Point = ORIGIN,
    axis_i: Point = Y,
    axis_j: Point = Y,
) -> Joint:
    """j slides along an axis: 5 constraints, K (13). Both bodies' axes have the same zero of turning."""
    a, b = make_axes(axis_i), make_axes(axis_j)
    held = hold_points(a[:2], AXES[:2], at_i, at_j)
    return Joint(name, i, j, [*held, *_hold_turn(a, b)], at_i, at_j, alike=list(zip(a, b, strict=True)))


def fixed(name: str, i: str, j: str, at_i: Point = ORIGIN, at_j: Point = ORIGIN) -> Joint:
    """j is one with i: 6 constraints."""
    held = hold_points(np.eye(3), ("x", "y", "z"), at_i, at_j)
    same = [(axis, axis) for axis in np.eye(3)]
    return Joint(name, i, j, [*held, *_hold_turn(np.eye(3), np.eye(3))], at_i, at_j, alike=same)


def prescribed_rotation(
    name: str,
    i: str,
    j: str,
    speed: float,
    angle: float = 0.0,
    acceleration: float = 0.0,
    axis_i: Point = Z,
    axis_j: Point = Z,
) -> Joint:
    """j turns against i by angle + speed t + acceleration t^2/2 (rad, s): 1 constraint, K (32).

    Its multiplier is the torque of the drive on j.
    """
    a, b = make_axes(axis_i), make_axes(axis_j)
    motion = {"angle": angle, "speed": speed, "acceleration": acceleration}
    if not all(map(math.isfinite, motion.values())):
        raise ModelError(f"joint {name}: {motion}: must be finite")
    return Joint(
        name, i, j, [Constraint("turning", {"kind": DRIVEN, "a": a[0], "a2": a[1], "b": b[0], **motion})]
    )


def _lie_across(axis: Point, first: Point) -> dict[str, Vector]:
    """The fields of a body that turns about an axis: a direction across it, and the one a quarter turn on."""
    a = find_direction(first)
    return {"a": a, "a2": np.cross(find_direction(axis), a)}


def flat_cam(
    name: str,
    cam: str,
    follower: str,
    profile: Any,
    *,
    at_cam: Point = ORIGIN,
    at_follower: Point = ORIGIN,
    foot: Point = Y,
) -> Joint:
    """A flat face stays on a cam: 1 constraint, R0 + s(psi) = n d. Its multiplier is the load W.

    `profile` is the record of the cam's parameters. It touches at psi = 0 where `foot`, of the cam, points
    along the face's normal y away from the cam, and psi grows as the cam turns about z. `at_follower` is a
    point of the face.
    """
    fields = {
        "kind": FLAT_CAM, **_lie_across(Z, foot), "b": find_direction(Y),
        "p_i": at_cam, "p_j": at_follower,
    }  # fmt: skip
    return Joint(name, cam, follower, [Constraint("contact", fields)], at_cam, at_follower, cam=profile)


@dataclass(frozen=True)
class LeverEnd:
    """The end of a lever: its arm (m) falls by the tilt (rad) below the line across the face's normal.

    It is a round pad of that radius (m), or an involute that keeps the velocity ratio a cos(tilt).
    """

    arm: float
    tilt: float = 0.0
    radius: float = 0.0
    constant_ratio: bool = False

    def __post_init__(self) -> None:
        check_values("lever's end", arm=self.arm, tilt=self.tilt, radius=self.radius)


def lever_end(
    name: str,
    lever: str,
    slider: str,
    end: LeverEnd,
    *,
    at_lever: Point = ORIGIN,
    at_slider: Point = ORIGIN,
    axis: Point = Z,
    normal: Point = Y,
) -> Joint:
    """The end of a lever stays on a flat face: 1 constraint, R0 + s(psi) = n d. Its multiplier is the load W.

    The lever turns by psi about `axis` through its pivot `at_lever`, which moves the face along its normal,
    away from the lever.
    """
    fields = {
        "kind": LEVER if end.constant_ratio else PAD, **_lie_across(axis, normal),
        "b": find_direction(normal), "p_i": at_lever, "p_j": at_slider, "arm": end.arm, "tilt": end.tilt,
        "offset": end.radius - end.arm * math.sin(end.tilt),
    }  # fmt: skip
    return Joint(name, lever, slider, [Constraint("contact", fields)], at_lever, at_slider)


def plane_contact(
    name: str, i: str, j: str, *, normal: Point = Y, at_i: Point = ORIGIN, at_j: Point = ORIGIN
) -> Joint:
    """A point of j stays on a plane of i, whose normal points to j: 1 constraint. Its multiplier is W."""
    inwards = -find_direction(normal)
    fields = {"kind": AHEAD, "a": inwards, "p_i": at_i, "p_j": at_j}
    return Joint(name, i, j, [Constraint("contact", fields)], at_i, at_j)
