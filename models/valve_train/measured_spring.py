"""Gaps between the coils of a spring from its measured force.

Of N equal segments, each of rate N k0, one closes after the other, at the forces F_i above the preload:

    x(F) = sum of min(F, F_i)/(N k0) + max(F - F_i, 0)/(N k0 + k_s)

with the stiffness k_s of closed coils. The share of closed coils is

    c(F) = (1/k0 - dx/dF)/(1/k0 - 1/(k0 + k_s/N))

Segment i closes at the mean of F while c goes from (i - 1)/N to i/N. Then the last measured force is met.
"""

from typing import NamedTuple

import numpy as np

from ..core.quantities import Vector


class MeasuredSpring(NamedTuple):
    """Static rate k0 (N/m), force at travel zero (N), and the gap of each segment (m), the least one last."""

    spring_rate: float
    preload: float
    gap: Vector


def fit_gaps(travel: Vector, force: Vector, segments: int, stop_stiffness: float) -> MeasuredSpring:
    """Of a measured force (N) that ascends with the travel (m), from travel zero.

    Where the rate falls with the travel it is taken as constant, as coils do not open: the flexibility dx/dF
    that is closest in least squares. A segment that stays open has twice the gap that it needs.
    ValueError if the spring gets stiffer than with all its coils closed.
    """
    above = force - force[0]
    step = np.diff(above)
    from scipy.optimize import isotonic_regression  # takes long to import

    flexibility = isotonic_regression(np.diff(travel) / step, weights=step, increasing=False).x
    free = flexibility[0]
    rate = 1.0 / free
    solid = rate + stop_stiffness / segments
    if flexibility[-1] * solid < 1.0:
        least = segments * (1.0 / flexibility[-1] - rate)
        raise ValueError(
            f"the rate gets {1.0 / flexibility[-1]:.4g} N/m, but with all {segments} coils closed it is "
            f"{solid:.4g} N/m: give a stop_stiffness of at least {least:.4g} N/m"
        )
    closed = (free - flexibility) / (free - 1.0 / solid)
    gap = np.empty(segments)
    for i in range(segments):
        gap[segments - 1 - i] = _close_segment(i, segments, above, closed) / (segments * rate)
    return MeasuredSpring(float(rate), float(force[0]), gap)


def _close_segment(i: int, segments: int, above: Vector, closed: Vector) -> float:
    """F_i: the last force less N times the integral of (last force - F) dc over the segment's share."""
    own = np.clip(closed, i / segments, (i + 1) / segments)
    before = float((above[-1] - above[:-1]) @ np.diff(own, prepend=i / segments))
    return float(above[-1]) - segments * before if before > 0.0 else 2.0 * float(above[-1])
