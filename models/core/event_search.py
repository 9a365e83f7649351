"""The first event within an integration step: which guard falls below zero first, and when.

The guards are sampled along the step's interpolant, and dips between samples are searched for: a guard that
falls and rises again within a step is seen if it falls by more than the step's error. Runge-Kutta steps of
other lengths from the same start then locate the event, as accurately as the integrator steps.
"""

from typing import Any, NamedTuple

import numpy as np

from ..compile.kernel import kernel
from .dormand_prince import Workspace, make_interpolate
from .integrator import copy, taylor

# Number of no guard. A literal would have numba compile what takes a guard's number once more for it.
NONE: Any = np.int64(-1)
# Where guards are sampled, in fractions of a step; the short end intervals tell the slope there.
FRACTIONS = (0.0, 1.0 / 64.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 63.0 / 64.0, 1.0)
# Narrows an interval by 1e-7: a minimum's value is then exact to rounding.
GOLDEN_STEPS = 34
GOLDEN = 0.6180339887498949
# The interpolant's root lies within this fraction of the step of the true root, mostly.
FIRST_BRACKET = 1e-7
ROOT_STEPS = 100


class Guards(NamedTuple):
    """Values of the guards: at the start of the step, at an instant within, and at FRACTIONS of the step."""

    start: Any
    now: Any
    samples: Any


class Bracket(NamedTuple):
    """Two lengths of a step and a guard after each: not negative after `low`, negative after `high`.

    high = -1: no such length was found.
    """

    low: float
    g_low: float
    high: float
    g_high: float


class Event(NamedTuple):
    """A guard and the length of step after which it has just fallen; without one NONE and the whole step."""

    guard: int
    after: float


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


def make_find_fall(guards_at: Any) -> Any:
    """find_fall(j, s, h, w, g): a fraction of the step at which guard j has fallen for the first time; 2 if
    it has not."""
    points = len(FRACTIONS)

    @kernel
    def search_dip(j: int, i: int, s: float, h: float, w: Workspace, g: Guards) -> float:
        """The same for the dip around sample i, by golden sections."""
        low, high = FRACTIONS[i - 1], FRACTIONS[i + 1]
        a, b = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        guards_at(a, s, h, w, g.now)
        ga = g.now[j]
        guards_at(b, s, h, w, g.now)
        gb = g.now[j]
        for _ in range(GOLDEN_STEPS):
            if ga < 0.0:
                return a
            if gb < 0.0:
                return b
            if ga < gb:
                high, b, gb = b, a, ga
                a = high - GOLDEN * (high - low)
                guards_at(a, s, h, w, g.now)
                ga = g.now[j]
            else:
                low, a, ga = a, b, gb
                b = low + GOLDEN * (high - low)
                guards_at(b, s, h, w, g.now)
                gb = g.now[j]
        return 2.0

    @kernel
    def find_fall(j: int, s: float, h: float, w: Workspace, g: Guards) -> float:
        samples = g.samples
        for i in range(1, points):
            if samples[i, j] < 0.0:
                return FRACTIONS[i]
            if i == points - 1 or samples[i - 1, j] < samples[i, j] or samples[i + 1, j] < samples[i, j]:
                continue
            low, middle, high = FRACTIONS[i - 1], FRACTIONS[i], FRACTIONS[i + 1]
            if vertex_is_far(low, middle, high, samples[i - 1, j], samples[i, j], samples[i + 1, j]):
                continue
            fall = search_dip(j, i, s, h, w, g)
            if fall <= 1.0:
                return fall
        return 2.0

    return find_fall


def make_bisect(guards_at: Any) -> Any:
    """bisect(j, high, s, h, w, g): the fraction at which guard j falls, by the interpolant; it has fallen at
    `high`."""

    @kernel
    def bisect(j: int, high: float, s: float, h: float, w: Workspace, g: Guards) -> float:
        low = 0.0
        for i in range(len(FRACTIONS)):
            if FRACTIONS[i] < high and g.samples[i, j] >= 0.0:
                low = FRACTIONS[i]
        while high - low > 0.01 * FIRST_BRACKET:
            middle = 0.5 * (low + high)
            guards_at(middle, s, h, w, g.now)
            if g.now[j] < 0.0:
                high = middle
            else:
                low = middle
        return high

    return bisect


def make_guard_after(guards: Any, runge_kutta: Any) -> Any:
    """guard_after(j, length, s, w, g): guard j after a Runge-Kutta step of that length, left in w.xn."""

    @kernel
    def guard_after(j: int, length: float, s: float, w: Workspace, g: Any) -> float:
        runge_kutta(s, length, w)
        taylor(w.U, s + length, w.u)
        guards(w.t + (s + length), w.xn, w.u, w.p, g)
        return g[j]

    return guard_after


def make_enclose(guard_after: Any) -> Any:
    """enclose(j, guess, s, h, resolution, w, g): a bracket of the length of the step at which guard j falls.

    It is as short as the guess is good.
    """

    @kernel
    def enclose(
        j: int, guess: float, s: float, h: float, resolution: float, w: Workspace, g: Guards
    ) -> Bracket:
        reach = FIRST_BRACKET * h + resolution
        low, g_low = 0.0, g.start[j]
        high = min(h, guess + reach)
        g_high = guard_after(j, high, s, w, g.now)
        while not g_high < 0.0:
            if high >= h:
                return Bracket(low, g_low, -1.0, g_high)
            low, g_low = high, g_high
            reach *= 10.0
            high = min(h, guess + reach)
            g_high = guard_after(j, high, s, w, g.now)
        reach = FIRST_BRACKET * h + resolution
        while low < guess - reach:
            trial = guess - reach
            g_trial = guard_after(j, trial, s, w, g.now)
            if g_trial < 0.0:
                high, g_high = trial, g_trial
                reach *= 10.0
            else:
                low, g_low = trial, g_trial
        return Bracket(low, g_low, high, g_high)

    return enclose


def make_locate(guard_after: Any, runge_kutta: Any) -> Any:
    """locate(j, guess, s, h, resolution, w, g): length of the step after which guard j has just fallen, with
    that step in w.xn; -1 if it does not fall within h."""
    enclose = make_enclose(guard_after)

    @kernel
    def locate(j: int, guess: float, s: float, h: float, resolution: float, w: Workspace, g: Guards) -> float:
        low, g_low, high, g_high = enclose(j, guess, s, h, resolution, w, g)
        if high < 0.0:
            return -1.0
        # Regula falsi (Illinois) until the bracket is as short as time can be told.
        side = 0
        for _ in range(ROOT_STEPS):
            if high - low <= resolution:
                break
            trial = high - g_high * (high - low) / (g_high - g_low)
            trial = min(max(trial, low + 0.5 * resolution), high - 0.5 * resolution)
            g_trial = guard_after(j, trial, s, w, g.now)
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
        runge_kutta(s, high, w)
        return high

    return locate


def make_find_event(guards: Any, runge_kutta: Any, n: int, count: int) -> Any:
    """find_event(s, h, resolution, w, g) -> Event: the first in the step of length h from w.x, which is in
    w.xn; the step up to the event is left there. g.start holds the guards at the start, and g.samples gets
    them all. Events are located to `resolution` (s).
    """
    interpolate = make_interpolate(n)
    points = len(FRACTIONS)

    @kernel
    def guards_at(f: float, s: float, h: float, w: Workspace, g: Any) -> None:
        """The guards at fraction f of the step, by the interpolant."""
        interpolate(f, h, w)
        taylor(w.U, s + f * h, w.u)
        guards(w.t + (s + f * h), w.xt, w.u, w.p, g)

    find_fall, bisect = make_find_fall(guards_at), make_bisect(guards_at)
    locate = make_locate(make_guard_after(guards, runge_kutta), runge_kutta)

    @kernel
    def find_event(s: float, h: float, resolution: float, w: Workspace, g: Guards) -> Event:
        copy(g.samples[0], g.start)
        for i in range(1, points - 1):
            guards_at(FRACTIONS[i], s, h, w, g.samples[i])
        taylor(w.U, s + h, w.u)
        guards(w.t + (s + h), w.xn, w.u, w.p, g.samples[points - 1])
        first, root = NONE, 2.0
        for j in range(count):
            fall = find_fall(j, s, h, w, g)
            if fall <= 1.0:
                fall = bisect(j, fall, s, h, w, g)
                if fall < root:
                    first, root = j, fall
        if first < 0:
            return Event(first, h)
        after = locate(first, root * h, s, h, resolution, w, g)
        if after >= 0.0:
            return Event(first, after)
        runge_kutta(s, h, w)  # the interpolant's dip was within the step's error
        return Event(NONE, h)

    return find_event
