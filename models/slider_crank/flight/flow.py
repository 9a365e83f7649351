"""The flow between impacts, exact to rounding: y'' = r(theta) + q(theta) y + d(theta) y'.

y is a distance from the walls' middle, theta the phase; r, q, d have the period 2 pi. The period is cut
into cells; in each one the particular solution and two fundamental ones are tabulated as power series.
r, q and d are sampled at the cells' starts; their series follow from the samples' Fourier coefficients,
which fall below rounding within the modes that the samples can tell apart. The cells are so short that the
solutions' series fall below rounding too.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ...compile.kernel import kernel
from ...core.errors import ModelError
from ...core.quantities import Vector
from .series import DEGREE, TERMS, value_and_slope

# Columns of samples: r, q, d, and the accelerations towards the walls of a slider that rests on them.
FORCING, STIFFNESS, DAMPING, PRESSING_UPPER, PRESSING_LOWER, COLUMNS = 0, 1, 2, 3, 4, 5
# Rows of `cells`: the solution from rest at zero, and what a unit of y and of y' at the start add.
PARTICULAR, OFFSET, RATE = 0, 1, 2
# Fourier coefficients in the upper quarter of the modes, against the largest: rounding is 1e-17.
UNRESOLVED = 1e-15
# A column that is a small difference (xi = 0.01, or much damping) has more rounding, whatever the cells.
ROUNDING = 1e-12
# With 64 cells r = 0.4 l is resolved, with 4096 r = 0.9998 l.
FEWEST_CELLS, MOST_CELLS = 64, 4096


class Flow(NamedTuple):
    """A tabulated flow; phase (k + u) 2 pi / cells is the place u in [0, 1) of cell k."""

    xi: float  # crank radius / rod length; 0 where psi = y
    cells: Any  # (cells, 3, TERMS) series of y in u; y' is per radian
    ends: Any  # (cells, 3, 2) their y and y' at the cell's end
    bounds: Any  # (cells, 4): r at least, r at most, |q| and |d| at most
    pressing: Any  # (cells, 2, TERMS) series of the acceleration towards the upper, the lower wall


def empty_flow(cells: int, xi: float) -> Flow:
    """Room for a flow of so many cells."""
    return Flow(
        xi,
        np.zeros((cells, 3, TERMS)),
        np.zeros((cells, 3, 2)),
        np.zeros((cells, 4)),
        np.zeros((cells, 2, TERMS)),
    )


@kernel
def transform(samples: Any, modes: Any) -> float:
    """Fourier coefficients of every column: modes[n, column] = (of cos, of sin).

    Returns the largest coefficient in the upper quarter of the modes, over the largest of its column.
    """
    count = samples.shape[0]
    width = 2.0 * math.pi / count
    unresolved = 0.0
    for column in range(COLUMNS):
        largest = tail = 0.0
        for n in range(count // 2):
            cosine = sine = 0.0
            for j in range(count):
                phase = width * ((n * j) % count)
                cosine += samples[j, column] * math.cos(phase)
                sine += samples[j, column] * math.sin(phase)
            weight = (1.0 if n == 0 else 2.0) / count
            modes[n, column, 0] = weight * cosine
            modes[n, column, 1] = weight * sine
            size = weight * (abs(cosine) + abs(sine))
            largest = max(largest, size)
            if n >= 3 * count // 8:
                tail = max(tail, size)
        if tail > unresolved * largest:
            unresolved = tail / largest
    return unresolved


@kernel
def expand(modes: Any, column: int, k: int, count: int, series: Any) -> None:
    """Series of a column from the start of cell k."""
    width = 2.0 * math.pi / count
    for i in range(TERMS):
        series[i] = 0.0
    for n in range(3 * count // 8):
        phase = width * ((n * k) % count)
        cosine, sine = math.cos(phase), math.sin(phase)
        even = modes[n, column, 0] * cosine + modes[n, column, 1] * sine
        odd = modes[n, column, 1] * cosine - modes[n, column, 0] * sine
        factor = 1.0
        for i in range(TERMS):
            series[i] += factor * even
            even, odd = odd, -even
            factor *= n * width / (i + 1.0)


@kernel
def solve_series(width: float, forced: float, r: Any, q: Any, d: Any, y: Any) -> None:
    """The series of y from y[0] and y[1] on; `forced`: 1 with r, 0 without."""
    for i in range(DEGREE - 1):
        total = forced * width * r[i]
        for j in range(i + 1):
            total += width * q[j] * y[i - j] + d[j] * (i - j + 1.0) * y[i - j + 1]
        y[i + 2] = width * total / ((i + 1.0) * (i + 2.0))


@kernel
def bounds(series: Any) -> tuple[float, float]:
    """Below and above a series on [0, 1]."""
    low = high = series[0]
    for i in range(1, TERMS):
        low += min(0.0, series[i])
        high += max(0.0, series[i])
    return low, high


@kernel
def largest_value(series: Any) -> float:
    """Above the absolute value of a series on [0, 1]."""
    low, high = bounds(series)
    return max(-low, high)


@kernel
def remainder(y: Any) -> float:
    """The last coefficient of a series over the sum of all; infinite if that is no number."""
    total = 0.0
    for i in range(TERMS):
        total += abs(y[i])
    return abs(y[DEGREE]) / total if total < math.inf else math.inf


@kernel
def tabulate(samples: Any, flow: Flow, modes: Any, series: Any) -> float:
    """Fill `flow` from samples (cells, COLUMNS) at the cells' starts; returns what is unresolved: of the
    samples (see `transform`) or of the solutions' series (see `rest`), which damping alone can make long.

    Scratch: modes (cells / 2, COLUMNS, 2), series (COLUMNS, TERMS).
    """
    count = samples.shape[0]
    width = 2.0 * math.pi / count
    unresolved = transform(samples, modes)
    for k in range(count):
        for column in range(COLUMNS):
            expand(modes, column, k, count, series[column])
        flow.bounds[k, 0], flow.bounds[k, 1] = bounds(series[FORCING])
        flow.bounds[k, 2] = largest_value(series[STIFFNESS])
        flow.bounds[k, 3] = largest_value(series[DAMPING])
        for i in range(TERMS):
            flow.pressing[k, 0, i] = series[PRESSING_UPPER, i]
            flow.pressing[k, 1, i] = series[PRESSING_LOWER, i]
        for row in range(3):
            y = flow.cells[k, row]
            y[0] = 1.0 if row == OFFSET else 0.0
            y[1] = width if row == RATE else 0.0
            solve_series(
                width,
                1.0 if row == PARTICULAR else 0.0,
                series[FORCING],
                series[STIFFNESS],
                series[DAMPING],
                y,
            )
            if row == RATE:
                unresolved = max(unresolved, remainder(y))
            end, slope = value_and_slope(y, 1.0)
            flow.ends[k, row, 0] = end
            flow.ends[k, row, 1] = slope / width
    return unresolved


class UnresolvedError(ModelError):
    """The flow varies too fast for the most cells that are tabulated."""


def tabulate_flow(sample: Callable[[int], Vector], xi: float = 0.0) -> Flow:
    """The flow whose samples (cells, COLUMNS) at so many equally spaced phases `sample` returns."""
    cells, before = FEWEST_CELLS, math.inf
    while cells <= MOST_CELLS:
        flow = empty_flow(cells, xi)
        modes, series = np.zeros((cells // 2, COLUMNS, 2)), np.zeros((COLUMNS, TERMS))
        unresolved = tabulate(sample(cells), flow, modes, series)
        if unresolved <= UNRESOLVED or 0.5 * before <= unresolved <= ROUNDING:
            return flow
        cells, before = 2 * cells, unresolved
    raise UnresolvedError(f"the flow is not resolved by {MOST_CELLS} cells a revolution")
