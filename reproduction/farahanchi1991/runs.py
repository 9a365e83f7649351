"""The motions behind the reproduction, each computed when asked for and kept."""

from __future__ import annotations

from functools import cache

import numpy as np

from models.slider_crank.motions.classification import Classification, classify
from models.slider_crank.motions.histories import ONSET
from models.slider_crank.motions.machine import Events, Motion
from models.slider_crank.motions.transients import Transients, draw_starts, measure_transients

from .cases import CYCLES, TRANSIENT, Case

# Cycles in which a repetition is sought: several times what F recorded.
SOUGHT = 20_000
# F does not give its start; statements about transients are judged over so many random ones.
STARTS = 24
STARTS_SOUGHT = 6000
# Longer periods are not seen as such in a figure.
LONGEST_SEEN = 8
# Chaos within so much of the gap looks periodic in F's figures.
NARROW = 0.02


class Runs:
    """Motions start in the middle, at rest relative to the nominal rod, where nothing else is said."""

    def __init__(self) -> None:
        self.events = cache(self._events)
        self.final = cache(self._final)
        self.kind = cache(self._kind)
        self.settling = cache(self._settling)
        self.band = cache(self._band)
        self.sliding_share = cache(self._sliding_share)
        self.orbit_slides = cache(self._orbit_slides)

    @staticmethod
    def motion(case: Case, after: int = TRANSIENT) -> Motion:
        """The motion after so many cycles."""
        return Motion(case.machine).skip(after)

    def _events(self, case: Case, cycles: int = CYCLES) -> Events:
        """All events of F's record."""
        return self.motion(case).events(cycles)

    def _final(self, case: Case) -> Events:
        """All events of one period after the transient, or of F's record where there is no period."""
        kind = self.kind(case)
        if not kind.period:
            return self.events(case)
        return self.motion(case, kind.transient + TRANSIENT).events(kind.period)

    @staticmethod
    def _kind(case: Case) -> Classification:
        return classify(case.machine, SOUGHT)

    @staticmethod
    def _settling(case: Case) -> Transients:
        return measure_transients(case.machine, draw_starts(case.machine, STARTS), STARTS_SOUGHT)

    def _band(self, case: Case, cycles: int = 1000) -> tuple[int, float]:
        """The shortest period that a motion keeps within NARROW, or else that of at most LONGEST_SEEN cycles
        that it keeps best, and the largest change of psi from one period to the next, over the gap."""
        psi = self.motion(case, 10 * TRANSIENT).strobe(cycles)[:, 0]
        changes = {p: float(np.abs(psi[p:] - psi[:-p]).max()) / case.gap for p in range(1, LONGEST_SEEN + 1)}
        best = min(changes, key=lambda p: changes[p])
        period = next((p for p, change in changes.items() if change < NARROW), best)
        return period, changes[period]

    def _sliding_share(self, case: Case, cycles: int = 200, points: int = 200) -> float:
        """Share of the time during which the roller slides."""
        _, states = self.motion(case).trace(cycles, points)
        return float(np.mean(states[:, 2] != 0.0))

    def _orbit_slides(self, case: Case, start: int) -> bool:
        """True if the orbit on which that one of the random starts settles has sliding in it, "
        "however short."""
        found = self.settling(case)
        motion = Motion(case.machine, *found.starts[start]).skip(int(found.lengths[start]) + TRANSIENT)
        begins = motion.events(int(found.periods[start])).kind == ONSET
        return bool(begins.any() or motion.strobe(1)[0, 2] != 0.0)
