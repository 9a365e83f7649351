"""Contacts of curves: cams with flat and round followers, and ends of levers."""

import math
from functools import cache
from typing import Any

from ..compile.kernel import kernel
from .constraints import (
    Curve,
    carry,
    differ,
    find_cam_angle,
    follow_cam,
    lift_end,
    point_at,
    roll_on_cam,
)
from .tables import FLAT_CAM, ROUND_CAM, Evaluation, Rows, Tables
from .vectors import dot

# Newton's steps to the normal of a round follower, their longest (rad), and the last.
NORMAL_STEPS, LONGEST_TURN, LAST_TURN = 50, 0.3, 1e-15


@cache
def make_curves(lift: Any) -> tuple[Any, Any]:
    """Kernels: find_profile(e, row, tables) of what a flat face touches, touch_curve(e, out, k, row, tables).

    `lift` is the kernel of cam profiles.
    """

    @kernel
    def find_profile(e: Evaluation, row: Any, tables: Tables) -> Curve:
        """Of a cam, or of a lever's end."""
        psi = find_cam_angle(e, row)
        if row.kind == FLAT_CAM:
            cam = tables.cams[row.cam]
            return Curve(cam.base_radius, lift(psi, cam))
        return Curve(row.offset, lift_end(psi, row))

    @kernel
    def find_normal(e: Evaluation, row: Any, cam: Any) -> float:
        """psi of the common normal of a cam and a round follower, s'(psi) = t d; from the line of centres."""
        arm_i, arm_j = carry(e, row.i, row.p_i), carry(e, row.j, row.p_j)
        d = differ(point_at(e, row.j, arm_j), point_at(e, row.i, arm_i)).value
        x, y = dot(carry(e, row.i, row.a).value, d), dot(carry(e, row.i, row.a2).value, d)
        psi = math.atan2(-y, x)
        for _ in range(NORMAL_STEPS):
            c, s, profile = math.cos(psi), math.sin(psi), lift(psi, cam)
            step = -(profile.ds + s * x + c * y) / (profile.dds + c * x - s * y)
            step = max(-LONGEST_TURN, min(LONGEST_TURN, step))
            psi += step
            if abs(step) <= LAST_TURN:
                break
        return psi

    @kernel
    def touch_curve(e: Evaluation, out: Rows, k: int, row: Any, tables: Tables) -> None:
        """Fill the row k, of a joint with a curve."""
        if row.kind == ROUND_CAM:
            cam = tables.cams[row.cam]
            psi = find_normal(e, row, cam)
            roll_on_cam(e, out, k, row, psi, Curve(cam.base_radius, lift(psi, cam)))
        else:
            follow_cam(e, out, k, row, find_profile(e, row, tables))

    return find_profile, touch_curve
