"""Truncated power series: first roots, bounds, and moves of the origin.

A series is the vector of its coefficients, c(u) = c[0] + c[1] u + ... + c[DEGREE] u^DEGREE; u = 1 is the
length of one cell of a `flow`, short against the radius of convergence.
"""

import math
from typing import Any

from ...compile.kernel import kernel

# With cells shorter than a twentieth of the radius of convergence the rest is below 1e-17.
DEGREE = 13
TERMS = DEGREE + 1
NEVER = 2.0
# A root is found when the next step would be smaller than this part of its distance from the origin.
RELATIVE = 4e-16
# Steps towards a root: three to five for a simple one, some 70 past a near miss of 1e-16 that is parabolic;
# 1/s towards a quartic one at s, where the bound of the bend is not the bend.
MOST_STEPS = 100_000


@kernel
def value(c: Any, u: float) -> float:
    """c(u)."""
    total = c[DEGREE]
    for i in range(DEGREE - 1, -1, -1):
        total = total * u + c[i]
    return total


@kernel
def value_and_slope(c: Any, u: float) -> tuple[float, float]:
    """c(u) and dc/du."""
    total = c[DEGREE]
    slope = 0.0
    for i in range(DEGREE - 1, -1, -1):
        slope = slope * u + total
        total = total * u + c[i]
    return total, slope


@kernel
def move_origin(c: Any, by: float) -> None:
    """Replace c(u) by c(u + by)."""
    for first in range(DEGREE):
        for i in range(DEGREE - 1, first - 1, -1):
            c[i] += by * c[i + 1]


@kernel
def bounds_of_bend(c: Any, length: float) -> tuple[float, float]:
    """Lower and upper bound of d^2c/du^2 on [0, length]."""
    low = high = 2.0 * c[2]
    power = length
    for i in range(3, DEGREE + 1):
        term = i * (i - 1.0) * c[i] * power
        if term < 0.0:
            low += term
        else:
            high += term
        power *= length
    return low, high


@kernel
def parabola_root(g: float, slope: float, bend: float) -> float:
    """The first s >= 0 at which g + slope s + bend s^2 / 2 falls to zero; infinite if never. g >= 0."""
    discriminant = slope * slope - 2.0 * bend * g
    if discriminant < 0.0 or (slope >= 0.0 and bend >= 0.0):
        return math.inf
    root = math.sqrt(discriminant)
    if slope <= 0.0:
        return 2.0 * g / (root - slope) if root > slope else 0.0
    return (slope + root) / -bend


@kernel
def first_fall(c: Any, sign: float, wall: float, bend: float, length: float) -> float:
    """The first u in [0, length] at which wall - sign c(u) falls to zero; NEVER if it does not.

    `bend` bounds its second derivative from below. From each point the parabola with that bend lies below
    the function, so that no root, single or double, is passed over; towards a simple root the steps
    converge quadratically.
    """
    u = 0.0
    for _ in range(MOST_STEPS):
        height, slope = value_and_slope(c, u)
        height = wall - sign * height
        if height < 0.0:
            return u
        step = parabola_root(height, -sign * slope, bend)
        u += step
        if u > length:
            return NEVER
        if step <= RELATIVE * u:
            return u
    return u


@kernel
def divide_by_u(c: Any, sign: float, quotient: Any) -> None:
    """quotient(u) = -sign (c(u) - c(0)) / u: a distance that is zero at the origin, divided by u."""
    for i in range(DEGREE):
        quotient[i] = -sign * c[i + 1]
    quotient[DEGREE] = 0.0


@kernel
def next_fall(quotient: Any, length: float) -> float:
    """The first u in (0, length] at which a distance u quotient(u) falls to zero again; NEVER if not."""
    low, _ = bounds_of_bend(quotient, length)
    return first_fall(quotient, -1.0, 0.0, low, length)
