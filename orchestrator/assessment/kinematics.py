"""The motion that a cam asks of its valve: that of a rigid train without lash, bending or lost contact."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import scipy

from models.core import roles
from models.core.quantities import Vector

from .trains import Train

# Knots at most of the spline through a lift that was recorded: closer ones show the rounding of its values in
# the second derivative.
KNOTS = 4000
# Of the polynomial from a rod's to a valve's end of a rocker: its remainder is below 1e-6 of the lift.
DEGREE = 6


class Kinematics(NamedTuple):
    """Lift (m), velocity (m/s) and acceleration (m/s2) at the times of records."""

    lift: Vector
    velocity: Vector
    acceleration: Vector


def find_kinematics(train: Train, time: Vector, values: Mapping[str, Vector]) -> Kinematics:
    """Of the cam's lift, which a rocker transmits as its ends have moved in these records."""
    lift = values[f"{train.cam}.cam_lift"]
    for rocker in train.list_parts(roles.Rocker):
        rod, tip = values[f"{rocker}.rod_position"], values[f"{rocker}.tip_position"]
        if np.ptp(rod) > 0.0:
            lift = np.polynomial.Polynomial.fit(rod, tip, DEGREE)(lift)
    # Rows of step control may lie within a rounding of each other.
    apart = (time[-1] - time[0]) / KNOTS
    _, kept = np.unique(np.floor((time - time[0]) / apart), return_index=True)
    spline = scipy.interpolate.CubicSpline(time[kept], lift[kept])
    return Kinematics(lift, spline(time, 1), spline(time, 2))
