"""Cam profile through points: lift, slope and curvature at cam angles, polynomials of degree 5 in between.

Quintic splines, and all piecewise polynomials up to degree 5 with continuous s'', are such profiles exactly.
Ramps may be added, as to a law.
"""

import math
from dataclasses import dataclass
from typing import Any

from ... import kinds
from ...compile.kernel import kernel
from ...core.points import find_point, measure_segment
from ...core.quantities import Vector
from ...core.requirements import require
from .lift import Lift
from .profile import Breaks, CamProfile, turn_to_break
from .ramps import RampParameters, add_ramp, add_ramp_breaks, ramp_turn

TURN = 2.0 * math.pi
# The description of an FMU has four variables for each point.
LEAST_POINTS, MOST_POINTS = 3, 2000


@dataclass
class PointParameters:
    """Angles ascend within one turn. After the last point the profile goes on to the first one."""

    base_radius: float = kinds.DIAMETER("base circle radius R0", 20e-3)
    smooth: float = kinds.SWITCH("s''' is continuous, as of a spline; false: it jumps at every point", 1.0)
    table_angle: Vector = kinds.ANGLE.each("cam angle of a point", "table_points")
    table_lift: Vector = kinds.DISPLACEMENT.each("lift s at a point", "table_points")
    table_slope: Vector = kinds.DISTANCE.each("s' at a point, by radian", "table_points")
    table_curvature: Vector = kinds.DISTANCE.each("s'' at a point, by radian squared", "table_points")
    event_begin: float = kinds.ANGLE("cam angle at which the opening ramp joins the event", 0.5 * math.pi)
    event_end: float = kinds.ANGLE("cam angle at which the closing ramp joins the event", 1.5 * math.pi)


@dataclass
class TableParameters(RampParameters, PointParameters):
    """Points with ramps."""


@dataclass(frozen=True)
class Points:
    """The points of a profile: `angle` (rad), `lift` (m), `slope` (m/rad), `curvature` (m/rad^2)."""

    angle: Vector
    lift: Vector
    slope: Vector
    curvature: Vector
    smooth: bool = True

    def parameters(self) -> dict[str, float]:
        """As parameters of a component with a table of so many points."""
        columns = {
            "table_angle": self.angle,
            "table_lift": self.lift,
            "table_slope": self.slope,
            "table_curvature": self.curvature,
        }
        values = {
            f"{name}[{i + 1}]": float(v) for name, column in columns.items() for i, v in enumerate(column)
        }
        return {"smooth": float(self.smooth)} | values


def check_table(points: int) -> None:
    """ValueError for a number of points out of range; 0 is none."""
    if points and not LEAST_POINTS <= points <= MOST_POINTS:
        raise ValueError(
            f"table_points = {points}: must be 0 (a cam by a law) or from {LEAST_POINTS} to {MOST_POINTS}"
        )


@kernel
def lift_between_points(angle: float, p: Any) -> Lift:
    """The polynomial of degree 5 that has s, s' and s'' of both ends of its segment."""
    i = find_point(angle, p.table_angle, TURN)
    into, h = measure_segment(i, angle, p.table_angle, TURN)
    j, x = (i + 1) % p.table_angle.size, into / h
    c0, c1, c2 = p.table_lift[i], h * p.table_slope[i], 0.5 * h * h * p.table_curvature[i]
    rest = p.table_lift[j] - (c0 + c1 + c2)
    slope_rest = h * p.table_slope[j] - (c1 + 2.0 * c2)
    curvature_rest = h * h * p.table_curvature[j] - 2.0 * c2
    c3 = 10.0 * rest - 4.0 * slope_rest + 0.5 * curvature_rest
    c4 = -15.0 * rest + 7.0 * slope_rest - curvature_rest
    c5 = 6.0 * rest - 3.0 * slope_rest + 0.5 * curvature_rest
    return Lift(
        c0 + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * c5)))),
        (c1 + x * (2.0 * c2 + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))) / h,
        (2.0 * c2 + x * (6.0 * c3 + x * (12.0 * c4 + x * 20.0 * c5))) / (h * h),
    )


@kernel
def table_lift(angle: float, p: Any) -> Lift:
    """The points' lift with the ramps, which part in the middle of the event."""
    half = 0.5 * (p.event_end - p.event_begin)
    past = angle - (p.event_begin + half) + math.pi
    from_middle = past - TURN * math.floor(past / TURN) - math.pi
    side = 1.0 if from_middle < 0.0 else -1.0
    cam = lift_between_points(angle, p)
    ramp = add_ramp(Lift(0.0, 0.0, 0.0), half + side * from_middle, side > 0.0, p)
    return Lift(cam.s + ramp.s, cam.ds + side * ramp.ds, cam.dds + ramp.dds)


@kernel
def find_table_breaks(angle: float, p: Any) -> Breaks:
    """Those of the ramps, and the nearest points where the table is not smooth."""
    breaks = add_ramp_breaks(True, p.event_begin, angle, Breaks(math.inf, math.inf), p)
    breaks = add_ramp_breaks(False, p.event_end, angle, breaks, p)
    if p.smooth != 0.0:
        return breaks
    n, i = p.table_angle.size, find_point(angle, p.table_angle, TURN)
    for near in range(i - 1, i + 3):
        breaks = turn_to_break(p.table_angle[near % n], angle, breaks)
    return breaks


@require(
    "table_angle[{0:.0f}] = {1:g} deg: must be less than the next one, {2:g} deg (of the last point: the "
    "first one a turn later)"
)
def angles_ascend(p: Any, numbers: Vector) -> bool:
    """Within one turn."""
    n = p.table_angle.size
    for i in range(n):
        following = p.table_angle[i + 1] if i + 1 < n else p.table_angle[0] + TURN
        if not p.table_angle[i] < following:
            numbers[0], numbers[1], numbers[2] = (
                i + 1.0,
                math.degrees(p.table_angle[i]),
                math.degrees(following),
            )
            return False
    return True


@require(
    "event_end - event_begin = {0:g} deg with a ramp of {1:g} deg: half the event and the ramp must be at "
    "most 180 deg, and the event at least twice ramp_blend_angle; shorten the ramps, or give other angles"
)
def ramps_fit(p: Any, numbers: Vector) -> bool:
    """Each in its half of the turn from the middle of the event."""
    if p.ramp_height == 0.0:
        return True
    event = p.event_end - p.event_begin
    longest = max(ramp_turn(True, p), ramp_turn(False, p))
    numbers[0], numbers[1] = math.degrees(event), math.degrees(longest)
    return event >= 2.0 * p.ramp_blend_angle and 0.5 * event + longest <= math.pi


TABLE = CamProfile(TableParameters, table_lift, find_table_breaks, (angles_ascend, ramps_fit))
