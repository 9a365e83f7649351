"""Finds, by rollback, when something happens inside a macro step, and what is known to happen ahead."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial

from models.core.quantities import Vector
from models.core.system import Port, System

from ..engine.consistency import make_consistent
from ..engine.coupling import Coupling
from ..engine.coupling_state import CouplingState, SavedPoint
from ..engine.signals import hermite
from ..masters import Master

# Attempts to close in on one event. Secant steps need three to eight, bisection forty.
ATTEMPTS = 60
# Events that follow the last one within this many tolerances are stepped over: chatter has no end.
SEPARATE = 100.0
# An event that was found from further away comes later, by rounding, from close by: crossing it may take a
# step twice as long, that many times.
WIDER = 8


def list_event_outputs(system: System) -> dict[str, list[str]]:
    """The outputs that tell of events, by instance."""
    found: dict[str, list[str]] = {}
    for name, instance in system.instances.items():
        c = instance.component
        outputs = [*c.event_indicators, c.event_counter, c.event_time, c.next_event]
        found[name] = [variable for variable in outputs if variable]
    return found


class Locator:
    """Events are changes of sign of indicators, and counts of events inside a participant.

    `tolerance` (s): how well an event's time is found. The step before it ends before anything jumps or
    bends, and a step of that length crosses it.
    """

    def __init__(self, coupling: Coupling, tolerance: float) -> None:
        self.tolerance = tolerance
        self._coupling = coupling
        self.last = -np.inf
        signs, counts, times, ahead = [], [], [], []
        for name, instance in coupling.wiring.system.instances.items():
            c = instance.component
            signs += [coupling.wiring.number[Port(name, v)] for v in c.event_indicators]
            if c.event_counter:
                counts.append(coupling.wiring.number[Port(name, c.event_counter)])
                times.append(coupling.wiring.number[Port(name, c.event_time)] if c.event_time else -1)
            if c.next_event:
                ahead.append(coupling.wiring.number[Port(name, c.next_event)])
        self._signs = np.array(signs, dtype=int)
        self._counts = np.array(counts, dtype=int)
        self._times = np.array(times, dtype=int)
        self._ahead = np.array(ahead, dtype=int)

    def ahead(self, time: float) -> float:
        """When the next known event is due, at least the tolerance after `time`; infinite if none."""
        due = self._coupling.state.values[self._ahead]
        return float(due[due > time + self.tolerance].min(initial=np.inf))

    def due(self, time: float) -> bool:
        """A known event is due at `time`."""
        return bool(np.any(np.abs(self._coupling.state.values[self._ahead] - time) <= self.tolerance))

    def bent(self, time: float, source: int = -1) -> Any:
        """The sources whose rates do not hold next to the event that `source` tells of, or one due at `time`.

        Rates are differences over a small part of the motion, across what bends at an indicator's zero or
        at a known time: outputs of the participant that tells of it, and of those that it tells.
        An event inside a participant changes its state, and rates follow from the state.
        """
        e = self._coupling
        bent = np.zeros(len(e.wiring.sources), dtype=np.bool_)
        telling = [i for i in self._ahead if abs(e.state.values[i] - time) <= self.tolerance]
        telling += [source] if source in self._signs else []
        for i in telling:
            for own, fed in zip(e.wiring.slices, e.wiring.columns, strict=True):
                bent[own] |= own.start <= i < own.stop or i in fed
        return bent

    def find_event(self, before: Vector) -> int:
        """The source that tells of an event between the values `before` and now; -1 if none does."""
        now = self._coupling.state.values
        changed = np.sign(before[self._signs]) * np.sign(now[self._signs]) < 0.0
        if changed.any():
            return int(self._signs[np.argmax(changed)])
        counted = now[self._counts] > before[self._counts]
        return int(self._counts[np.argmax(counted)]) if counted.any() else -1

    def _find_dip(self, start: SavedPoint, length: float) -> float:
        """`find_dip` of the indicators that give rates."""
        state = self._coupling.state
        return find_dip(self._signs[state.history.rated[self._signs]], start.coupling, state, length)

    def locate(
        self, start: SavedPoint, time: float, length: float, attempt: Callable[[float], None]
    ) -> tuple[float, float, int]:
        """Length of the step from `time` to just before its first event, how long to cross it, its source.

        An attempt of `length` has been made; `attempt` makes others, from the same start. The last one is
        that of the length returned, unless that is zero. Without an event, or with one too close to the
        last: `length`, 0, -1 (a shorter one where something seemed to have happened and been undone inside).
        """
        before = start.coupling.values
        while True:
            if self.find_event(before) < 0:
                shorter = self._find_dip(start, length)
                if shorter == length:
                    return length, 0.0, -1
                attempt(shorter)
                length = shorter
                if self.find_event(before) < 0:
                    return length, 0.0, -1
            low, high, source, made = self._close_in(before, time, length, attempt)
            if time + high - self.last <= SEPARATE * self.tolerance:
                attempt(length)
                return length, 0.0, -1
            if low > 0.0 and made != low:
                attempt(low)
            # Another event before this one, that had been undone?
            if low == 0.0 or self._find_dip(start, low) == low:
                return low, high - low, source
            length = low

    def _close_in(
        self, before: Vector, time: float, length: float, attempt: Callable[[float], None]
    ) -> tuple[float, float, int, float]:
        """Lengths just before and after an event, its source, and the length of the last attempt."""
        low, high, made, source = 0.0, length, length, self.find_event(before)
        self._coupling.state.history.end_smooth[:] = ~self.bent(time + length, source)
        values = {0.0: before.copy(), length: self._coupling.state.values.copy()}
        for _ in range(ATTEMPTS):
            if high - low <= self.tolerance:
                break
            guess = self._guess(values, low, high, time)
            # Close in from both sides.
            for trial in (guess + 0.5 * self.tolerance, guess - 0.5 * self.tolerance):
                if not low < trial < high:
                    continue
                attempt(trial)
                made = trial
                values[trial] = self._coupling.state.values.copy()
                found = self.find_event(before)
                if found >= 0:
                    high, source = trial, found
                else:
                    low = trial
        return low, high, source, made

    def cross(self, master: Master, time: float, gap: float, before: Vector | None = None) -> float:
        """Step from the point at `time`, just before an event, over it; returns how far that was.

        `gap` at first, and further until what tells of the event has changed since `before` (None: it
        comes at a known time). Values may jump there, so nothing smooth leads over it: the jump has no
        effect longer than this step. Then outputs and rates are made consistent with what is in effect
        after the event, and the history begins there.
        """
        coupling = self._coupling
        coupling.state.warm_starts = {}
        with coupling.points.keep() as saved:
            master.step(coupling, time, gap)
            for _ in range(WIDER):
                if before is None or self.find_event(before) >= 0:
                    break
                coupling.points.restore(saved)
                gap *= 2.0
                master.step(coupling, time, gap)
        make_consistent(coupling, time + gap)
        coupling.state.warm_starts = {}
        return gap

    def _guess(self, values: dict[float, Vector], low: float, high: float, time: float) -> float:
        """When the first event may be, after the start of the step; the middle if nothing tells."""
        a, b = values[low], values[high]
        crossing = [i for i in self._signs if np.sign(a[i]) * np.sign(b[i]) < 0.0]
        guesses = [high, *(low + (high - low) * a[i] / (a[i] - b[i]) for i in crossing)]
        for count, at in zip(self._counts, self._times, strict=True):
            if b[count] > a[count]:
                guesses.append(b[at] - time if at >= 0 else 0.5 * (low + high))
        guess = float(min(guesses))
        margin = 0.02 * (high - low)
        inside = low + margin < guess < high - margin or high - low < 50.0 * self.tolerance
        # A secant that clings to one end makes no progress: move in from there.
        return guess if inside else float(np.clip(guess, low + margin, high - margin))


def find_dip(indicators: Any, before: CouplingState, now: CouplingState, length: float) -> float:
    """How long after the start an indicator may be on its other side and back at the end of the step.

    By the cubics through values and rates at both ends; `length` if none dips.
    """
    whole = length
    for i in indicators:
        v, r, end, end_rate = before.values[i], before.rates[i], now.values[i], now.rates[i]
        # It lies within the hull of its Bezier points: on its other side only if one of them is.
        if min(v * (v + r * whole / 3.0), v * (end - end_rate * whole / 3.0), v * end) >= 0.0:
            continue
        second, third = hermite(v, r, end, end_rate, whole)
        polynomial: Any = Polynomial([v, r, second / 2.0, third / 6.0])
        for s in polynomial.deriv().roots():
            if np.isreal(s) and 0.0 < s.real < length and polynomial(s.real) * v < 0.0:
                length = float(s.real)
    return length
