"""The error of a signal's extrapolation over a step, as amounts of a few polynomial shapes."""

import math
from functools import cache

import numpy as np
from numpy.polynomial import Polynomial

from models.core.quantities import Vector

from ...engine.signals import DEGREES
from .linear import ROWS

HERMITE = DEGREES["hermite"]


def compute_extrapolation_error(
    values: Vector, rates: Vector, step: float, degree: int, middles: Vector | None = None
) -> Vector:
    """Values minus their extrapolation: amounts of the `shapes`, (instants x shapes x sources).

    `values` and `rates` (instants x sources) are a macro step apart; row n of the result is for the step that
    ends at instant n, and zero without a full past. `middles` are values halfway, row n for the step that
    ends at instant n + 1.
    """
    amounts = np.zeros((len(values), len(build_shapes(step, degree)), values.shape[1]))
    if degree != HERMITE:
        amounts[degree + 1 :, 0] = np.diff(values, degree + 1, axis=0)
        return amounts
    # The cubic through the last two values and rates, one step on; rates are those times the step.
    slopes = step * rates
    first, start, end = values[:-2], values[1:-1], values[2:]
    guess = 5.0 * first - 4.0 * start + 2.0 * slopes[:-2] + 4.0 * slopes[1:-1]
    guessed_slope = 12.0 * (first - start) + 5.0 * slopes[:-2] + 8.0 * slopes[1:-1]
    amounts[2:, 0] = end - guess
    amounts[2:, 1] = slopes[2:] - guessed_slope
    if middles is None:
        # Exact for a polynomial of fourth order.
        amounts[2:, 2] = amounts[2:, 0] / 64.0
    else:
        amounts[2:, 2] = middles[1 : len(values) - 1] - (
            0.5 * (start + end) + 0.125 * (slopes[1:-1] - slopes[2:])
        )
    return amounts


@cache
def build_shapes(step: float, degree: int) -> Vector:
    """Taylor coefficients (shapes x ROWS), at the start of a step, of the error of a signal of `degree`.

    The shape vanishes at the signal's known values and is one at the end of the step. Hermite signals have
    three shapes, because rates may jump: value one at the end, rate one (per step) at the end, and one in the
    middle with neither.
    """
    s = Polynomial([0.0, 1.0 / step])
    if degree == HERMITE:
        polynomials = [3.0 * s**2 - 2.0 * s**3, s**3 - s**2, 16.0 * s**2 * (1.0 - s) ** 2]
    else:
        polynomials = [Polynomial([1.0])]
        for k in range(degree + 1):
            polynomials[0] = polynomials[0] * (s + float(k)) / (k + 1.0)
    coefficients = np.zeros((len(polynomials), ROWS))
    for row, shape in zip(coefficients, polynomials, strict=True):
        row[: len(shape.coef)] = shape.coef
    coefficients *= [math.factorial(k) for k in range(ROWS)]
    coefficients.flags.writeable = False
    return coefficients


def evaluate_ends(step: float, degree: int) -> Vector:
    """Values and rates (2 x shapes) of the shapes at the end of the step."""
    powers = np.array([step**k / math.factorial(k) for k in range(ROWS)])
    coefficients = build_shapes(step, degree)
    return np.array([coefficients @ powers, coefficients[:, 1:] @ powers[:-1]])
