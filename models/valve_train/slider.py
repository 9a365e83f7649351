"""Dry friction that sticks: a spring with a damper, in series with a Coulomb slider.

The touching surfaces give by z before they slide (Prandtl 1928, Jenkins 1962), so that they stick without an
event. With the limit T_c, which may vary, and the rate v at which the bodies move past each other,

    T  = k (z + tau v), between -T_c and T_c       where it is cut off, the surfaces slide
    z' = (T/k - z)/tau                             v, while they stick

T v is the rate of k z^2/2 and losses, none of them negative. Forces and metres, or torques and radians.
"""

import math
from typing import Annotated, NamedTuple

from .. import kinds
from ..compile.kernel import kernel

StickingStiffness = Annotated[
    float, kinds.STIFFNESS.of("stiffness k of the sticking surfaces", nominal=1e7, positive=True)
]
RelaxationTime = Annotated[
    float, kinds.TIME.of("damping of their shift over the stiffness, tau", nominal=1e-5, positive=True)
]
Creep = Annotated[float, kinds.PLACE.of("elastic shift z of the sticking surfaces", nominal=1e-6)]


class Slip(NamedTuple):
    """What sticking would take, what is transmitted, and the rates z' and of sliding, v - z'."""

    sticking: float
    transmitted: float
    rate: float
    sliding: float


@kernel
def find_slip(z: float, v: float, limit: float, stiffness: float, relaxation_time: float) -> Slip:
    sticking = stiffness * (z + relaxation_time * v)
    if abs(sticking) <= limit:
        return Slip(sticking, sticking, v, 0.0)
    transmitted = math.copysign(limit, sticking)
    rate = (transmitted / stiffness - z) / relaxation_time
    return Slip(sticking, transmitted, rate, v - rate)


@kernel
def lost_power(slip: Slip, stiffness: float, relaxation_time: float) -> float:
    """By sliding, which has the sign of T, and by the damped spring."""
    return slip.transmitted * slip.sliding + stiffness * relaxation_time * slip.rate**2
