"""Input signals: polynomials in time through exchanged values.

A signal of degree k goes through k + 1 known values: the last ones (extrapolation), or the last ones
and a value at the end of the step (interpolation; degree 0 then holds the end value). With fewer known
values than that the degree is lower. Compiled, because this runs several times in every macro step.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

from models.quantities import Vector

from .errors import one_of

DEGREES = {"hold": 0, "linear": 1, "quadratic": 2}
POINTS = 3


def degree_of(name: str) -> int:
    """The degree of an input signal by name; ValueError with the known names."""
    if name not in DEGREES:
        raise ValueError(f"extrapolation = {name!r}: {one_of(DEGREES, name)}")
    return DEGREES[name]


class History:
    """The exchanged values at the last three communication points, newest first.

    `count` says how many are known.
    """

    def __init__(self, time: float, values: Vector) -> None:
        self.times: Vector = np.full(POINTS, time)
        self.values: Vector = np.tile(values, (POINTS, 1))
        self.count = 1

    def append(self, time: float, values: Vector) -> None:
        """The values at a later communication point; the oldest are forgotten."""
        push(self.times, self.values, time, values)
        self.appended()

    def appended(self) -> None:
        """Values have been put into the memory."""
        if self.count < POINTS:
            self.count += 1


@numba.njit(cache=True)
def push(times: Any, values: Any, time: float, new: Any) -> None:
    for k in range(values.shape[0] - 1, 0, -1):
        times[k] = times[k - 1]
        values[k] = values[k - 1]
    times[0] = time
    values[0] = new


@numba.njit(cache=True)
def parabola(t0: float, v0: float, t1: float, v1: float, t2: float, v2: float, points: int, at: float) -> Any:
    """Value, first and second derivative at `at` of the polynomial through the first `points` points."""
    if points == 1:
        return v0, 0.0, 0.0
    d1 = (v0 - v1) / (t0 - t1)
    s = at - t0
    if points == 2:
        return v0 + s * d1, d1, 0.0
    d2 = (d1 - (v1 - v2) / (t1 - t2)) / (t0 - t2)
    return v0 + s * (d1 + (at - t1) * d2), d1 + (s + at - t1) * d2, 2.0 * d2


@numba.njit(cache=True)
def _store(out: Any, i: int, value: float, slope: float, curvature: float) -> None:
    out[0, i] = value
    if out.shape[0] > 1:
        out[1, i] = slope
    if out.shape[0] > 2:
        out[2, i] = curvature


@numba.njit(cache=True)
def _extrapolate(times: Any, values: Any, count: int, degree: int, out: Any) -> None:
    points = min(degree + 1, count)
    t0, t1, t2 = times[0], times[1], times[2]
    for i in range(values.shape[1]):
        v, d, c = parabola(t0, values[0, i], t1, values[1, i], t2, values[2, i], points, t0)
        _store(out, i, v, d, c)


@numba.njit(cache=True)
def interpolate_part(
    times: Any, values: Any, count: int, degree: int, end: float, new: Any, out: Any, first: int, last: int
) -> bool:
    points = min(degree, count) + 1
    finite = True
    for i in range(first, last):
        finite &= math.isfinite(new[i])
        at = times[0]
        v, d, c = parabola(end, new[i], at, values[0, i], times[1], values[1, i], points, at)
        _store(out, i, v, d, c)
    return finite


def extrapolate(history: History, degree: int, out: Vector) -> None:
    """Derivatives (coefficients x n) at the newest point of the polynomial through degree + 1 points."""
    _extrapolate(history.times, history.values, history.count, degree, out)


def interpolate(history: History, degree: int, end: float, values: Vector, out: Vector) -> bool:
    """As `extrapolate`, through the last `degree` points and `values` at the time `end`; True if finite."""
    return interpolate_part(  # type: ignore[no-any-return]
        history.times, history.values, history.count, degree, end, values, out, 0, len(values)
    )


@numba.njit(cache=True)
def gather(signals: Any, columns: Any, out: Any) -> None:
    """out[k, j] = signals[k, columns[j]]."""
    for k in range(out.shape[0]):
        for j in range(columns.shape[0]):
            out[k, j] = signals[k, columns[j]]


@numba.njit(cache=True)
def append_judged(
    times: Any,
    values: Any,
    count: int,
    time: float,
    new: Any,
    nominal: Any,
    keep: float,
    bound: float,
    share: float,
    missed: Any,
    size: Any,
) -> int:
    """The source that most misses its own linear extrapolation, if it does by more than `share`; else -1.

    Updates the fading sums (kept by the factor `keep` per step) of what each source misses and of its
    size, and appends the new values to the history's memory. A value above `bound` nominal sizes counts as
    well.
    """
    worst, most = -1, share
    for i in range(new.shape[0]):
        v, d, _ = parabola(times[0], values[0, i], times[1], values[1, i], 0.0, 0.0, min(count, 2), times[0])
        missed[i] = keep * missed[i] + abs(new[i] - (v + (time - times[0]) * d))
        size[i] = keep * size[i] + max(abs(new[i]), nominal[i])
        if missed[i] > most * size[i]:
            worst, most = i, missed[i] / size[i]
        elif abs(new[i]) > bound * nominal[i] and worst < 0:
            worst = i
    push(times, values, time, new)
    return worst


@numba.njit(cache=True)
def move_origin(signals: Any, shift: float, out: Any) -> None:
    """The signals' derivatives at a time `shift` later; `out` may be `signals` itself."""
    for k in range(signals.shape[0]):
        for i in range(signals.shape[1]):
            value, factor = 0.0, 1.0
            for j in range(k, signals.shape[0]):
                value += factor * signals[j, i]
                factor *= shift / (j - k + 1)
            out[k, i] = value
