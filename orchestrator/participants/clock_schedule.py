"""When the clocks of an FMU tick."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

from .description3 import ASKED, TRIGGERED, Clock

UNKNOWN, CHANGED = 0, 2
# Two instants within that part of the time, or of 1 s, are one: sums of intervals are rounded.
SAME = 1e-12


def find_latest(time: float) -> float:
    """The latest instant (s) that counts as `time`."""
    return time + SAME * max(abs(time), 1.0)


class ClockSchedule:
    """The input clocks that tick by time, and the next tick (s) of each in a list that is kept elsewhere.

    `ask` gets the references of clocks, and gives their intervals (s) and qualifiers. The k-th tick of a
    steady clock is at shift + k * interval: a sum of intervals would drift.
    """

    def __init__(
        self, clocks: Iterable[Clock], ask: Callable[[Sequence[int]], list[tuple[float, int]]]
    ) -> None:
        known = list(clocks)
        self._ask = ask
        self._references = {clock.name: clock.reference for clock in known}
        self._timed = [c for c in known if c.causality == "input" and c.variability != TRIGGERED]
        self.outputs = [c.name for c in known if c.causality == "output"]
        self._intervals = [math.nan] * len(self._timed)
        self._starts: list[float] = []

    def get_references(self, names: Iterable[str]) -> list[int]:
        return [self._references[name] for name in names]

    def begin(self, time: float) -> list[float]:
        """The first tick of each clock of a run that starts at `time`, its first event."""
        asked = [c for c in self._timed if c.interval is None or c.variability in ASKED]
        told = dict(zip((c.name for c in asked), self._ask_all(asked), strict=True))
        first = []
        for i, clock in enumerate(self._timed):
            interval, qualifier = told.get(clock.name, (clock.interval or math.inf, CHANGED))
            self._intervals[i] = math.inf if qualifier == UNKNOWN else interval
            waits = self._intervals[i] if clock.variability == "countdown" else clock.shift
            first.append(time + waits)
        self._starts = first.copy()
        return first

    def list_due(self, ticks: Sequence[float], time: float) -> list[str]:
        """The clocks that tick at `time`."""
        latest = find_latest(time)
        return [c.name for c, tick in zip(self._timed, ticks, strict=True) if tick <= latest]

    def advance(self, ticks: list[float], ticking: Sequence[str], time: float) -> None:
        """After an event at `time` in which these clocks ticked: when each ticks next."""
        asked = [c for c in self._timed if c.variability in ASKED]
        told = dict(zip((c.name for c in asked), self._ask_all(asked), strict=True))
        for i, clock in enumerate(self._timed):
            ticked = clock.name in ticking
            interval, qualifier = told.get(clock.name, (self._intervals[i], 1))
            if clock.variability == "countdown":
                if qualifier == CHANGED:
                    ticks[i] = time + interval
                elif ticked or qualifier == UNKNOWN:
                    ticks[i] = math.inf
            elif clock.variability in ASKED:
                if qualifier == CHANGED:
                    self._intervals[i] = interval
                if ticked:
                    ticks[i] = time + self._intervals[i]
            elif ticked:
                count = round((time - self._starts[i]) / self._intervals[i]) + 1
                ticks[i] = self._starts[i] + count * self._intervals[i]

    def _ask_all(self, clocks: Sequence[Clock]) -> list[tuple[float, int]]:
        return self._ask([c.reference for c in clocks]) if clocks else []
