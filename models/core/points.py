"""Points of a function that repeats itself."""

import math
from typing import NamedTuple

from ..compile.kernel import kernel
from .quantities import Vector


class Segment(NamedTuple):
    """Between two points: the angle from the first one, and that from it to the second."""

    into: float
    length: float


@kernel
def find_point(at: float, points: Vector, period: float) -> int:
    """The last of `points`, which ascend within a period, that is not after `at`; by bisection."""
    into = at - points[0]
    into -= period * math.floor(into / period)
    low, high = 0, points.size
    while high - low > 1:
        middle = (low + high) // 2
        if points[middle] - points[0] <= into:
            low = middle
        else:
            high = middle
    return low


@kernel
def measure_segment(first: int, at: float, points: Vector, period: float) -> Segment:
    """That between point `first` and the next one; the segment of the last point closes the period."""
    into = at - points[0]
    into -= period * math.floor(into / period)
    begin = points[first] - points[0]
    end = points[first + 1] - points[0] if first + 1 < points.size else period
    return Segment(into - begin, end - begin)
