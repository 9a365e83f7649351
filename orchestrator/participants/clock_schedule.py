"""When the clocks of an FMU tick."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple, Protocol

from .description3 import CHANGING, COUNTDOWN, TRIGGERED, Clock

UNKNOWN, CHANGED = 0, 2
# Two instants within that part of the time, or of 1 s, are one: sums of intervals are rounded.
SAME = 1e-12


def find_latest(time: float) -> float:
    """The latest instant (s) that counts as `time`."""
    return time + SAME * max(abs(time), 1.0)


class Pace(NamedTuple):
    """Of a clock: its next tick (s), and the time (s) from which it ticks periodically, with its interval
    (s). Ticks are at since + k interval: a sum of intervals would drift."""

    next: float
    since: float
    interval: float


class Intervals(Protocol):
    """What an FMU says of clocks, by their references, in initialisation and event mode."""

    def ask_intervals(self, references: Sequence[int]) -> list[tuple[float, int]]:
        """Intervals (s) with their qualifiers: UNKNOWN, 1 unchanged, CHANGED."""

    def ask_shifts(self, references: Sequence[int]) -> list[float]:
        """Times (s) from the start to the first tick."""


class ClockSchedule:
    """The input clocks that tick by time; their paces are kept elsewhere, in this order.

    Periodic clocks whose description states no interval are asked for it, and again in every event, as
    countdowns are; changing ones when they have ticked.
    """

    def __init__(self, clocks: Iterable[Clock], fmu: Intervals) -> None:
        known = list(clocks)
        self._fmu = fmu
        self._references = {clock.name: clock.reference for clock in known}
        self._timed = [c for c in known if c.causality == "input" and c.variability != TRIGGERED]
        self.outputs = [c.name for c in known if c.causality == "output"]

    def get_references(self, names: Iterable[str]) -> list[int]:
        return [self._references[name] for name in names]

    def begin(self, time: float, given: Mapping[str, float]) -> list[Pace]:
        """Of a run that starts at `time`, with these intervals of settable clocks; in initialisation mode."""
        asked = [c for c in self._timed if c.interval is None]
        periodic = [c for c in asked if c.variability not in (CHANGING, COUNTDOWN)]
        intervals = self._ask(asked)
        references = [c.reference for c in periodic]
        shifts = self._fmu.ask_shifts(references) if references else []
        shift = dict(zip((c.name for c in periodic), shifts, strict=True))
        paces = []
        for clock in self._timed:
            stated = given.get(clock.name, clock.interval or math.inf)
            interval, qualifier = intervals.get(clock.name, (stated, CHANGED))
            if qualifier == UNKNOWN:
                interval = math.inf
            aperiodic = clock.variability in (CHANGING, COUNTDOWN)
            first = time + (interval if aperiodic else shift.get(clock.name, clock.shift))
            paces.append(Pace(first, first, interval))
        return paces

    def list_due(self, paces: Sequence[Pace], time: float) -> list[str]:
        """The clocks that tick at `time`."""
        latest = find_latest(time)
        return [c.name for c, pace in zip(self._timed, paces, strict=True) if pace.next <= latest]

    def advance(self, paces: list[Pace], ticking: Sequence[str], time: float) -> None:
        """At the end of event mode at `time`, in which these clocks ticked: when each ticks next."""
        intervals = self._ask(
            [
                c
                for c in self._timed
                if c.interval is None and (c.variability != CHANGING or c.name in ticking)
            ]
        )
        for i, (clock, pace) in enumerate(zip(self._timed, paces, strict=True)):
            interval, qualifier = intervals.get(clock.name, (pace.interval, 1))
            ticked = clock.name in ticking
            if qualifier == CHANGED or (clock.variability == CHANGING and ticked):
                paces[i] = Pace(time + interval, time, interval)  # from the present, not from the last tick
            elif clock.variability == COUNTDOWN and (ticked or qualifier == UNKNOWN):
                paces[i] = Pace(math.inf, time, math.inf)
            elif ticked:
                count = round((time - pace.since) / pace.interval) + 1
                paces[i] = pace._replace(next=pace.since + count * pace.interval)

    def _ask(self, clocks: Sequence[Clock]) -> dict[str, tuple[float, int]]:
        """The intervals of these clocks, with their qualifiers, by name."""
        found = self._fmu.ask_intervals([c.reference for c in clocks]) if clocks else []
        return dict(zip((c.name for c in clocks), found, strict=True))
