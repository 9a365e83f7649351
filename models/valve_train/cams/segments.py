"""A rise by segments of its acceleration: straight lines between joints, as a designer lists them.

What is above zero is multiplied by one factor, what is below by another, so that the velocity ends with zero
and the lift with the one that is asked for. Lift and slope at the joints are exact: the lift is a cubic on
each segment, which the points of `table` have without error.
"""

from typing import NamedTuple

import numpy as np

from ...core.quantities import Vector
from .table import Points


class Rise(NamedTuple):
    """Joints of a rise: angle from its foot (rad), s (m), s' (m/rad), s'' (m/rad^2)."""

    angle: Vector
    lift: Vector
    slope: Vector
    curvature: Vector


def scale_rise(angle: Vector, acceleration: Vector, lift: float) -> Rise:
    """The rise by this lift (m) of relative accelerations at ascending angles (rad) from 0.

    ValueError where no factors make it end at rest with that lift.
    """
    angle, acceleration = _split_at_zeros(angle, acceleration)
    parts = np.maximum(acceleration, 0.0), np.maximum(-acceleration, 0.0)
    (up_lift, up_slope), (down_lift, down_slope) = (_integrate(angle, part) for part in parts)
    if not (up_slope[-1] > 0.0 and down_slope[-1] > 0.0):
        raise ValueError("must accelerate and decelerate: it has accelerations of one sign only")
    ratio = up_slope[-1] / down_slope[-1]
    gained = up_lift[-1] - ratio * down_lift[-1]
    if not gained > 0.0:
        raise ValueError("decelerates before it accelerates: the lift would end below zero")
    up, down = lift / gained, ratio * lift / gained
    return Rise(
        angle,
        up * up_lift - down * down_lift,
        up * up_slope - down * down_slope,
        up * parts[0] - down * parts[1],
    )


def join_sides(rise: Rise, fall: Rise, nose: float, dwell: float) -> Points:
    """The cam with its nose at that angle (rad), a dwell there, and the fall, which is given as a rise.

    ValueError where s'' would jump at the nose.
    """
    ends = rise.curvature[-1], fall.curvature[-1]
    unequal = max(map(abs, ends)) if dwell > 0.0 else abs(ends[0] - ends[1])
    if unequal > 1e-9 * float(np.max(np.abs(rise.curvature))):
        raise ValueError(
            "the acceleration jumps at the nose: end rise and fall with 0, or without dwell with the same "
            f"acceleration (here {1e3 * ends[0]:.4g} and {1e3 * ends[1]:.4g} mm/rad^2)"
        )
    last = None if dwell > 0.0 else -1  # without dwell the nose is one point
    opening = nose - 0.5 * dwell - rise.angle[-1] + rise.angle
    closing = (nose + 0.5 * dwell + fall.angle[-1] - fall.angle[:last])[::-1]
    return Points(
        np.append(opening, closing),
        np.append(rise.lift, fall.lift[:last][::-1]),
        np.append(rise.slope, -fall.slope[:last][::-1]),
        np.append(rise.curvature, fall.curvature[:last][::-1]),
        smooth=False,
    )


def _split_at_zeros(angle: Vector, acceleration: Vector) -> tuple[Vector, Vector]:
    """With a joint where a segment crosses zero."""
    before, after = acceleration[:-1], acceleration[1:]
    i = np.flatnonzero(before * after < 0.0)
    share = before[i] / (before[i] - after[i])
    crossing = angle[i] + share * (angle[i + 1] - angle[i])
    return np.insert(angle, i + 1, crossing), np.insert(acceleration, i + 1, 0.0)


def _integrate(angle: Vector, acceleration: Vector) -> tuple[Vector, Vector]:
    """Lift and slope at the joints, from rest."""
    h, begin, end = np.diff(angle), acceleration[:-1], acceleration[1:]
    slope = np.append(0.0, np.cumsum(0.5 * h * (begin + end)))
    lift = np.append(0.0, np.cumsum(h * slope[:-1] + h * h * (2.0 * begin + end) / 6.0))
    return lift, slope
