"""What a signal's extrapolation misses of a true value."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from models.quantities import Vector

from ..signals import DEGREES
from .linear import ROWS

HERMITE = DEGREES["hermite"]


def missed_by(values: Vector, rates: Vector, step: float, degree: int) -> Vector:
    """What the values (instants x sources, a macro step apart) miss their extrapolation by.

    Row n is for the step that ends at instant n; rows without a full past are zero.
    """
    missed = np.zeros_like(values)
    if degree == HERMITE:
        # The cubic through the last two values and rates, one step on.
        guess = 5.0 * values[:-2] - 4.0 * values[1:-1] + step * (2.0 * rates[:-2] + 4.0 * rates[1:-1])
        missed[2:] = values[2:] - guess
    else:
        missed[degree + 1 :] = np.diff(values, degree + 1, axis=0)
    return missed


@cache
def missing(step: float, degree: int) -> Vector:
    """Taylor coefficients, at the start of a step, of the polynomial that a signal of `degree` misses.

    It vanishes at all that the signal knows and is one at the end of the step.
    """
    if degree == HERMITE:
        s = np.polynomial.Polynomial([0.0, 1.0 / step])
        shape = s**2 * (s + 1.0) ** 2 / 4.0
    else:
        shape = np.polynomial.Polynomial([1.0])
        for k in range(degree + 1):
            shape = shape * np.polynomial.Polynomial([float(k), 1.0 / step]) / (k + 1.0)
    coefficients = np.zeros(ROWS)
    coefficients[: len(shape.coef)] = shape.coef
    coefficients *= [math.factorial(k) for k in range(ROWS)]
    coefficients.flags.writeable = False
    return coefficients


def powers(step: float) -> Vector:
    """step^k / k!, for the value of a Taylor polynomial."""
    return np.array([step**k / math.factorial(k) for k in range(ROWS)])
