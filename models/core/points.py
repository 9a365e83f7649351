"""Points of a function that repeats itself."""

import math
from typing import NamedTuple

from ..compile.kernel import kernel
from .quantities import Vector


class Segment(NamedTuple):
    """Between two points: the first one's index, the angle from it, the angle to the second, its index."""

    first: int
    into: float
    length: float
    last: int


@kernel
def find_segment(at: float, points: Vector, period: float) -> Segment:
    """The segment of `points`, which ascend within a period, by bisection; the last one closes the period."""
    n = points.size
    into = at - points[0]
    into -= period * math.floor(into / period)
    low, high = 0, n
    while high - low > 1:
        middle = (low + high) // 2
        if points[middle] - points[0] <= into:
            low = middle
        else:
            high = middle
    begin = points[low] - points[0]
    end = points[high] - points[0] if high < n else period
    return Segment(low, into - begin, end - begin, high if high < n else 0)
