"""Integration across events: the Runge-Kutta step of `integrator`, cut where a guard falls below zero.

After each step that the error control accepts, the guards are sampled along the step's own interpolant
(Dormand-Prince, fourth order); a dip between samples is searched for, so that a double root is seen if
it is deeper than the step's error. The event itself is then located with Runge-Kutta steps of other
lengths from the same start: its time has the accuracy of the integrator, not of the interpolant.

Nothing is remembered between calls: the guards' sign at the start decides. A guard that is negative
there (an input has jumped) makes its transition at once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..compile.kernel import kernel, shaped
from .integrator import (
    MOST_STEPS,
    NOT_FINITE,
    OK,
    STEP_TOO_SMALL,
    TOO_MANY_EVENTS,
    TOO_MANY_STEPS,
    copy,
    make_derivative_along,
    make_runge_kutta,
    taylor,
    work_size,
)
from .quadrature import make_interpolate, make_quadrature

if TYPE_CHECKING:
    from .component import Component

# No guard. A literal would have numba compile what takes a guard's number once more for it.
NONE: Any = np.int64(-1)
# Where guards are sampled, in fractions of a step; the short end intervals tell the slope there.
FRACTIONS = (0.0, 1.0 / 64.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 63.0 / 64.0, 1.0)
# Narrows an interval by 1e-7: a minimum's value is then exact to rounding.
GOLDEN_STEPS = 34
GOLDEN = 0.6180339887498949
# The interpolant's root lies within this fraction of the step of the true root, mostly.
FIRST_BRACKET = 1e-7
ROOT_STEPS = 100
# Events without progress of time after which the step is given up: chatter that its component does not
# end needs ln(1e16)/ln(1/e) of them to stand still in time (350 for e = 0.9).
STALLED_EVENTS = 1000
# Events in one call: bounces so low that rounding keeps them up pass time, but too slowly to end.
MOST_EVENTS = 100_000


def hybrid_work_size(component: Component) -> int:
    """Length of the scratch vector that the advance made here needs."""
    count = component.events.count if component.events else 0
    samples = len(FRACTIONS) * count
    return work_size(component.state, component.inputs) + component.state.size + samples + 2 * count


@kernel
def vertex_is_far(a: float, b: float, c: float, ga: float, gb: float, gc: float) -> bool:
    """True if a guard with samples ga >= gb <= gc > 0 stays clear of zero.

    The parabola through them must stay above a quarter of its own sagitta, room for the terms that it
    does not see.
    """
    left, right = (gb - ga) / (b - a), (gc - gb) / (c - b)
    bend = (right - left) / (c - a)
    if bend <= 0.0:
        return True
    slope = left + bend * (b - a)
    return gb - slope**2 / (4.0 * bend) > 0.25 * bend * max(b - a, c - b) ** 2


def make_hybrid_advance(component: Component) -> Any:
    """advance(t, h, x, U, p, scale, work) -> status, as `integrator.make_advance`, with the events."""
    assert component.events is not None
    n, m, count = component.state.size, component.inputs.size, component.events.count
    guards, transition = component.flat_guards, component.flat_transition
    derivative_along = make_derivative_along(component.flat_derivative)
    runge_kutta = make_runge_kutta(derivative_along, n, component.tolerance)
    interpolate = make_interpolate(n)
    quadrature = make_quadrature(component.sample, n)
    points = len(FRACTIONS)

    @kernel
    def guards_between(
        f: float, t: float, s: float, h: float, x: Any, xn: Any, U: Any, u: Any, p: Any, k: Any, xd: Any,
        g: Any,
    ) -> None:  # fmt: skip
        """The guards at fraction f of the step, by the interpolant."""
        interpolate(f, h, x, xn, k, xd)
        taylor(U, s + f * h, u)
        guards(t + (s + f * h), xd, u, p, g)

    @kernel
    def guard_between(
        j: int, f: float, t: float, s: float, h: float, x: Any, xn: Any, U: Any, u: Any, p: Any, k: Any,
        xd: Any, g: Any,
    ) -> float:  # fmt: skip
        """Guard j of them."""
        guards_between(f, t, s, h, x, xn, U, u, p, k, xd, g)
        return g[j]

    @kernel
    def fallen_by(
        j: int, t: float, s: float, h: float, x: Any, xn: Any, U: Any, u: Any, p: Any, k: Any, xd: Any,
        g: Any, samples: Any,
    ) -> float:  # fmt: skip
        """A fraction of the step at which guard j has fallen for the first time; 2 if it has not."""
        for i in range(1, points):
            if samples[i, j] < 0.0:
                return FRACTIONS[i]
            if i == points - 1 or samples[i - 1, j] < samples[i, j] or samples[i + 1, j] < samples[i, j]:
                continue
            low, high = FRACTIONS[i - 1], FRACTIONS[i + 1]
            if vertex_is_far(low, FRACTIONS[i], high, samples[i - 1, j], samples[i, j], samples[i + 1, j]):
                continue
            a, b = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
            ga = guard_between(j, a, t, s, h, x, xn, U, u, p, k, xd, g)
            gb = guard_between(j, b, t, s, h, x, xn, U, u, p, k, xd, g)
            for _ in range(GOLDEN_STEPS):
                if ga < 0.0:
                    return a
                if gb < 0.0:
                    return b
                if ga < gb:
                    high, b, gb = b, a, ga
                    a = high - GOLDEN * (high - low)
                    ga = guard_between(j, a, t, s, h, x, xn, U, u, p, k, xd, g)
                else:
                    low, a, ga = a, b, gb
                    b = low + GOLDEN * (high - low)
                    gb = guard_between(j, b, t, s, h, x, xn, U, u, p, k, xd, g)
        return 2.0

    @kernel
    def root_between(
        j: int, high: float, t: float, s: float, h: float, x: Any, xn: Any, U: Any, u: Any, p: Any, k: Any,
        xd: Any, g: Any, samples: Any,
    ) -> float:  # fmt: skip
        """The fraction at which guard j falls, by the interpolant; it has fallen at `high`."""
        low = 0.0
        for i in range(points):
            if FRACTIONS[i] < high and samples[i, j] >= 0.0:
                low = FRACTIONS[i]
        while high - low > 0.01 * FIRST_BRACKET:
            middle = 0.5 * (low + high)
            if guard_between(j, middle, t, s, h, x, xn, U, u, p, k, xd, g) < 0.0:
                high = middle
            else:
                low = middle
        return high

    @kernel
    def guard_after(
        j: int, length: float, t: float, s: float, x: Any, U: Any, u: Any, p: Any, scale: Any, k: Any,
        xt: Any, xn: Any, g: Any,
    ) -> float:  # fmt: skip
        """Guard j after a Runge-Kutta step of that length, which is left in xn."""
        runge_kutta(t, s, length, x, U, u, p, scale, k, xt, xn)
        taylor(U, s + length, u)
        guards(t + (s + length), xn, u, p, g)
        return g[j]

    @kernel
    def locate(
        j: int, guess: float, h: float, resolution: float, g0: float, t: float, s: float, x: Any, U: Any,
        u: Any, p: Any, scale: Any, k: Any, xt: Any, xn: Any, g: Any,
    ) -> float:  # fmt: skip
        """Length of the step after which guard j has just fallen, that step in xn; -1 if it does not."""
        reach = FIRST_BRACKET * h + resolution
        low, g_low = 0.0, g0
        high = min(h, guess + reach)
        g_high = guard_after(j, high, t, s, x, U, u, p, scale, k, xt, xn, g)
        while not g_high < 0.0:
            if high >= h:
                return -1.0
            low, g_low = high, g_high
            reach *= 10.0
            high = min(h, guess + reach)
            g_high = guard_after(j, high, t, s, x, U, u, p, scale, k, xt, xn, g)
        reach = FIRST_BRACKET * h + resolution
        while low < guess - reach:
            trial = guess - reach
            g_trial = guard_after(j, trial, t, s, x, U, u, p, scale, k, xt, xn, g)
            if g_trial < 0.0:
                high, g_high = trial, g_trial
                reach *= 10.0
            else:
                low, g_low = trial, g_trial
        # Regula falsi (Illinois) until the bracket is as short as time can be told.
        side = 0
        for _ in range(ROOT_STEPS):
            if high - low <= resolution:
                break
            trial = high - g_high * (high - low) / (g_high - g_low)
            trial = min(max(trial, low + 0.5 * resolution), high - 0.5 * resolution)
            g_trial = guard_after(j, trial, t, s, x, U, u, p, scale, k, xt, xn, g)
            if g_trial < 0.0:
                high, g_high = trial, g_trial
                if side < 0:
                    g_low *= 0.5
                side = -1
            else:
                low, g_low = trial, g_trial
                if side > 0:
                    g_high *= 0.5
                side = 1
        runge_kutta(t, s, high, x, U, u, p, scale, k, xt, xn)
        return high

    @kernel
    def settle(t: float, s: float, x: Any, U: Any, u: Any, p: Any, g: Any) -> int:
        """Make the transitions of all guards that are negative; the guards are left in g."""
        taylor(U, s, u)
        for _ in range(4 * count):
            guards(t + s, x, u, p, g)
            fallen = NONE
            for j in range(count):
                if g[j] < 0.0:
                    fallen = j
                    break
            if fallen < 0:
                return OK
            transition(fallen, t + s, x, u, p)
        return TOO_MANY_EVENTS

    @kernel
    def advance(t: float, h: float, x: Any, U: Any, p: Any, scale: Any, work: Any) -> int:
        k, xt, xn = work[0 : 7 * n], work[7 * n : 8 * n], work[8 * n : 9 * n]
        start, xd = work[9 * n : 10 * n], work[10 * n : 11 * n]
        u = work[11 * n : 11 * n + m]
        rest = work[11 * n + m :]
        g0, g = rest[0:count], rest[count : 2 * count]
        samples = shaped(rest[2 * count : (2 + points) * count], (points, count))
        copy(start, x)
        s, micro, stalled, events, tried = 0.0, h, 0, 0, 0
        status = settle(t, s, x, U, u, p, g0)
        derivative_along(t, 0.0, x, U, u, p, k[0:n])
        while s < h and status == OK:
            tried += 1
            if tried > MOST_STEPS:
                status = TOO_MANY_STEPS
                break
            last = s + micro >= h
            length = h - s if last else micro
            # Time cannot be told apart more finely than this.
            resolution = 1e-15 * h + 4e-16 * abs(t)
            error = runge_kutta(t, s, length, x, U, u, p, scale, k, xt, xn)
            if not error <= 1.0:
                if length <= 10.0 * resolution:
                    status = NOT_FINITE if not error < 1e300 else STEP_TOO_SMALL
                micro = length * (max(0.2, 0.9 * error**-0.2) if error < 1e300 else 0.2)
                continue
            copy(samples[0], g0)
            for i in range(1, points - 1):
                guards_between(FRACTIONS[i], t, s, length, x, xn, U, u, p, k, xd, samples[i])
            taylor(U, s + length, u)
            guards(t + (s + length), xn, u, p, samples[points - 1])
            first, root = NONE, 2.0
            for j in range(count):
                fallen = fallen_by(j, t, s, length, x, xn, U, u, p, k, xd, g, samples)
                if fallen <= 1.0:
                    fallen = root_between(j, fallen, t, s, length, x, xn, U, u, p, k, xd, g, samples)
                    if fallen < root:
                        first, root = j, fallen
            happened, at = False, length
            if first >= 0:
                at = locate(
                    first, root * length, length, resolution, g0[first], t, s, x, U, u, p, scale, k, xt, xn, g
                )
                happened = at >= 0.0
                if not happened:  # the interpolant's dip was within the step's error
                    runge_kutta(t, s, length, x, U, u, p, scale, k, xt, xn)
                    at = length
            quadrature(t, s, at, x, xn, k, U, u, p, xd, work)
            copy(x, xn)
            if happened:
                stalled = stalled + 1 if at <= 2.0 * resolution else 0
                s += at
                taylor(U, s, u)
                transition(first, t + s, x, u, p)
                status = settle(t, s, x, U, u, p, g0)
                events += 1
                if stalled > STALLED_EVENTS or events > MOST_EVENTS:
                    status = TOO_MANY_EVENTS
                derivative_along(t, s, x, U, u, p, k[0:n])
            else:
                s = h if last else s + length
                micro = length * min(5.0, 0.9 * max(error, 1e-10) ** -0.2)
                copy(g0, samples[points - 1])
                copy(k[0:n], k[6 * n : 7 * n])
        if status != OK:
            copy(x, start)
        return status

    return advance
