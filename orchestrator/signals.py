"""Input signals: polynomials in time through exchanged values.

A signal of degree k goes through k + 1 known values: the last ones (extrapolation), or the last ones
and a value at the end of the step (interpolation; degree 0 then holds the end value). With fewer known
values than that, at the start, the degree is lower.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from models.quantities import Vector

DEGREES = {"hold": 0, "linear": 1, "quadratic": 2}


class History:
    """The exchanged values at the last three communication points, newest last."""

    def __init__(self, time: float, values: Vector) -> None:
        self.times: list[float] = [time]
        self.values: list[Vector] = [values.copy()]

    def append(self, time: float, values: Vector) -> None:
        if len(self.times) == 3:
            self.times.pop(0)
            oldest = self.values.pop(0)
            oldest[:] = values
            self.values.append(oldest)
        else:
            self.values.append(values.copy())
        self.times.append(time)


def taylor_through(origin: float, times: Sequence[float], values: Sequence[Vector], out: Vector) -> None:
    """Value, first and second derivative at `origin` of the parabola (or less) through up to three
    points; the rest of `out` (3 x n) is zero. Newton's divided differences, newest point first.
    """
    out[:] = 0.0
    t0, v0 = times[-1], values[-1]
    s = origin - t0
    out[0] = v0
    if len(times) == 1:
        return
    d1 = (v0 - values[-2]) / (t0 - times[-2])
    if len(times) == 2:
        out[0] += s * d1
        out[1] = d1
        return
    d1_old = (values[-2] - values[-3]) / (times[-2] - times[-3])
    d2 = (d1 - d1_old) / (t0 - times[-3])
    out[0] += s * (d1 + (origin - times[-2]) * d2)
    out[1] = d1 + (s + origin - times[-2]) * d2
    out[2] = 2.0 * d2


def extrapolate(history: History, degree: int, out: Vector) -> None:
    """Derivatives at the newest point of the polynomial through the last degree + 1 points."""
    n = degree + 1
    taylor_through(history.times[-1], history.times[-n:], history.values[-n:], out)


def interpolate(
    history: History, degree: int, end: float, values: Vector, out: Vector, part: slice = slice(None)
) -> None:
    """As `extrapolate`, through the last `degree` points and `values` at the time `end`.

    `part` restricts the history to the sources that `values` and `out` are about.
    """
    if degree == 0:
        out[:] = 0.0
        out[0] = values
        return
    times = [*history.times[-degree:], end]
    known = [past[part] for past in history.values[-degree:]]
    taylor_through(history.times[-1], times, [*known, values], out)


def predict(history: History, time: float) -> Vector:
    """The linear extrapolation at `time` (the newest value, where only one is known)."""
    newest = history.values[-1]
    if len(history.times) == 1:
        return newest
    slope = (newest - history.values[-2]) / (history.times[-1] - history.times[-2])
    return np.asarray(newest + (time - history.times[-1]) * slope)
