"""Input signals: polynomials in time through exchanged values.

A signal of degree k goes through k + 1 known values: the last ones (extrapolation), or the last ones
and a value at the end of the step (interpolation; degree 0 then holds the end value). The cubic Hermite
signal goes through two values and their rates; for a source that gives no rate it is the quadratic one.
With fewer known values than that the degree is lower, and so it is where a participant that the value goes
to follows a lower one only (`History.degrees`). A value that changes at events only (STEPWISE) stays over the
step what it is at its start. Compiled, because this runs several times in every
macro step.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from typing import Any

import numpy as np

from models.compile.array_pointers import ArrayPointers, integers, mark_table, marks, numbers, table
from models.compile.compiled import compiled
from models.core.quantities import Vector

from ..errors import one_of

DEGREES = {"hold": 0, "linear": 1, "quadratic": 2, "hermite": 3}
POINTS = 3
# The degree of a signal that is held whatever the others are.
STEPWISE = -1

# Known points from which on a signal of each degree extrapolates at its full order.
NEEDED = (1, 2, 3, 2)


def find_degree(name: str) -> int:
    """The degree of an input signal by name; ValueError with the known names."""
    if name not in DEGREES:
        raise ValueError(f"extrapolation = {name!r}: {one_of(DEGREES, name)}")
    return DEGREES[name]


class History:
    """The exchanged values and their rates at the last three communication points, newest first.

    `count` says how many are known, `rated` which sources give rates. Where a derivative jumps, at an event,
    a rate has no meaning: `smooth` says at which points which sources' rates are used, `end_smooth` of which
    they are at the end of the step that is being made. `degrees` are the highest that signals may have.
    """

    def __init__(
        self, time: float, values: Vector, rates: Vector | None = None, rated: Any | None = None
    ) -> None:
        self.times: Vector = np.full(POINTS, time)
        self.values: Vector = np.tile(values, (POINTS, 1))
        self.rates: Vector = np.zeros((POINTS, len(values)))
        if rates is not None:
            self.rates[:] = rates
        self.rated = np.zeros(len(values), dtype=np.bool_) if rated is None else rated
        self.degrees = np.full(len(values), max(DEGREES.values()), dtype=np.int64)
        self.smooth = np.ones((POINTS, len(values)), dtype=np.bool_)
        self.end_smooth = np.ones(len(values), dtype=np.bool_)
        self.count = 1

    @cached_property
    def memory(self) -> Any:
        """The addresses of its arrays, for compiled code."""
        self._addressed = ArrayPointers(
            times=self.times, values=self.values, rates=self.rates, rated=self.rated, degrees=self.degrees,
            smooth=self.smooth, end_smooth=self.end_smooth,
        )  # fmt: skip
        return self._addressed.record

    def begin(self, time: float, values: Vector, rates: Vector) -> None:
        """Only this point is known."""
        self.times[:], self.values[:], self.rates[:] = time, values, rates
        self.smooth[:], self.end_smooth[:] = True, True
        self.count = 1

    def append(self, time: float, values: Vector, rates: Vector) -> None:
        """The values at a later communication point; the oldest are forgotten."""
        _push(self.memory, time, values, rates)
        if self.count < POINTS:
            self.count += 1

    @contextmanager
    def passing(self) -> Iterator[None]:
        """For steps to a point on the way, where rates are used."""
        kept = self.end_smooth.copy()
        self.end_smooth[:] = True
        try:
            yield
        finally:
            self.end_smooth[:] = kept

    def restart(self, smooth: Any = False) -> None:
        """Only the newest point is known, and which rates there: what was before does not go on smoothly."""
        self.count = 1
        self.smooth[0] = smooth

    def lacks(self, degree: int) -> bool:
        """Too few points are known for signals of that degree to extrapolate at their full order."""
        return self.count < NEEDED[degree] or (degree == 3 and not _smooth(self.memory))

    def copy(self) -> History:
        """An independent copy, between steps."""
        twin = History(0.0, self.values[0], rated=self.rated)
        twin.degrees = self.degrees
        twin.put(self)
        return twin

    def put(self, other: History) -> None:
        """Become equal to `other`."""
        self.times[:] = other.times
        self.values[:] = other.values
        self.rates[:] = other.rates
        self.smooth[:] = other.smooth
        self.count = other.count


@compiled
def _smooth(memory: Any) -> bool:
    """The rates of all sources are used at the last two points."""
    smooth = mark_table(memory[0].smooth)
    known = True
    for i in range(smooth.shape[1]):
        known &= smooth[0, i] and smooth[1, i]
    return known


@compiled
def _push(memory: Any, time: float, new: Any, new_rates: Any) -> None:
    m = memory[0]
    times, values, rates, smooth = numbers(m.times), table(m.values), table(m.rates), mark_table(m.smooth)
    for k in range(values.shape[0] - 1, 0, -1):
        times[k] = times[k - 1]
        for i in range(values.shape[1]):
            values[k, i], rates[k, i], smooth[k, i] = values[k - 1, i], rates[k - 1, i], smooth[k - 1, i]
    times[0] = time
    for i in range(values.shape[1]):
        values[0, i], rates[0, i], smooth[0, i] = new[i], new_rates[i], True


@compiled
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


@compiled
def hermite(v0: float, r0: float, v1: float, r1: float, h: float) -> Any:
    """Second and third derivative, at the first point, of the cubic through two values and rates.

    The second point lies h later (h < 0: earlier).
    """
    d = (v1 - v0) / h
    return 2.0 * (3.0 * d - 2.0 * r0 - r1) / h, 6.0 * (r0 + r1 - 2.0 * d) / (h * h)


@compiled
def cubic(v0: float, r0: float, smooth: bool, v1: float, r1: float, smooth_1: bool, h: float) -> Any:
    """First to third derivative at the first point of the signal through two values and their rates.

    The second point lies h later (h < 0: earlier). Rates are used where it is smooth: cubic with both,
    parabola with one, straight line with none.
    """
    if smooth and smooth_1:
        second, third = hermite(v0, r0, v1, r1, h)
        return r0, second, third
    d = (v1 - v0) / h
    if smooth:
        return r0, 2.0 * (d - r0) / h, 0.0
    if smooth_1:
        return 2.0 * d - r1, 2.0 * (r1 - d) / h, 0.0
    return d, 0.0, 0.0


@compiled
def _store(out: Any, i: int, value: float, slope: float, curvature: float, third: float) -> None:
    out[0, i] = value
    if out.shape[0] > 1:
        out[1, i] = slope
    if out.shape[0] > 2:
        out[2, i] = curvature
    if out.shape[0] > 3:
        out[3, i] = third


@compiled
def _extrapolate(memory: Any, count: int, degree: int, out: Any) -> None:
    m = memory[0]
    times, values, rates, rated = numbers(m.times), table(m.values), table(m.rates), marks(m.rated)
    smooth, degrees = mark_table(m.smooth), integers(m.degrees)
    t0, t1, t2 = times[0], times[1], times[2]
    for i in range(values.shape[1]):
        third, own = 0.0, min(degree, degrees[i])
        if own == 3 and rated[i]:
            v, c = values[0, i], 0.0
            d = rates[0, i] if smooth[0, i] else 0.0
            if count > 1:
                d, c, third = cubic(v, d, smooth[0, i], values[1, i], rates[1, i], smooth[1, i], t1 - t0)
        else:
            points = min(max(min(own, 2), 0) + 1, count)
            v, d, c = parabola(t0, values[0, i], t1, values[1, i], t2, values[2, i], points, t0)
        _store(out, i, v, d, c, third)


@compiled
def interpolate_part(
    memory: Any,
    count: int,
    degree: int,
    end: float,
    new: Any,
    new_rates: Any,
    out: Any,
    first: int,
    last: int,
) -> bool:
    """Interpolate the sources from `first` up to `last`; True if their new values are finite."""
    m = memory[0]
    times, values, rates, rated = numbers(m.times), table(m.values), table(m.rates), marks(m.rated)
    smooth, end_smooth, degrees = mark_table(m.smooth), marks(m.end_smooth), integers(m.degrees)
    finite = True
    at = times[0]
    for i in range(first, last):
        finite &= math.isfinite(new[i])
        third, own = 0.0, min(degree, degrees[i])
        if own == 3 and rated[i]:
            finite &= math.isfinite(new_rates[i])
            v = values[0, i]
            d, c, third = cubic(v, rates[0, i], smooth[0, i], new[i], new_rates[i], end_smooth[i], end - at)
        elif own == STEPWISE and degree > 0:
            v, d, c = values[0, i], 0.0, 0.0
        else:
            points = min(max(min(own, 2), 0), count) + 1
            v, d, c = parabola(end, new[i], at, values[0, i], times[1], values[1, i], points, at)
        _store(out, i, v, d, c, third)
    return finite


def extrapolate(history: History, degree: int, out: Vector) -> None:
    """Derivatives (coefficients x n) at the newest point of the polynomials through the last points."""
    _extrapolate(history.memory, history.count, degree, out)


def interpolate(
    history: History, degree: int, end: float, values: Vector, rates: Vector, out: Vector
) -> bool:
    """As `extrapolate`, through the last points and `values` (`rates`) at the time `end`; True if finite."""
    found: bool = interpolate_part(
        history.memory, history.count, degree, end, values, rates, out, 0, len(values)
    )
    return found


@compiled
def evaluate(signals: Any, s: float, values: Any, rates: Any) -> None:
    """Values and rates of the polynomials at a time s after their origin."""
    for i in range(values.shape[0]):
        v, r = 0.0, 0.0
        for k in range(signals.shape[0] - 1, -1, -1):
            if k > 0:
                r = signals[k, i] + r * s / k
            v = signals[k, i] + v * s / (k + 1)
        values[i], rates[i] = v, r


@compiled
def gather(signals: Any, sources: Any, targets: Any, out: Any) -> None:
    """out[targets[j]] = signals[k, i], where sources[j] counts the signals row by row."""
    n = signals.shape[1]
    for j in range(sources.shape[0]):
        out[targets[j]] = signals[sources[j] // n, sources[j] % n]


@compiled
def finite(values: Any, rates: Any, first: int, last: int) -> bool:
    """All values and rates of the sources from `first` up to `last` are finite."""
    known = True
    for i in range(first, last):
        known &= math.isfinite(values[i]) and math.isfinite(rates[i])
    return known


@compiled
def move_origin(signals: Any, shift: float, out: Any) -> None:
    """The signals' derivatives at a time `shift` later; `out` may be `signals` itself."""
    for k in range(signals.shape[0]):
        for i in range(signals.shape[1]):
            value, factor = 0.0, 1.0
            for j in range(k, signals.shape[0]):
                value += factor * signals[j, i]
                factor *= shift / (j - k + 1)
            out[k, i] = value
