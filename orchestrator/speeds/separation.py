"""The speed at which a train first loses contact."""

from __future__ import annotations

import math
from collections.abc import Callable

# Of the speed (rad/s): 0.1 r/min.
CLOSE = 0.1 * math.pi / 30.0


def bisect_separation(separated: Callable[[float], bool], kept: float, lost: float) -> float:
    """A speed (rad/s) of separation, to CLOSE, between one that keeps contact and one that loses it."""
    while lost - kept > CLOSE:
        middle = 0.5 * (kept + lost)
        if separated(middle):
            lost = middle
        else:
            kept = middle
    return lost
