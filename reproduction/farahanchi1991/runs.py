"""F's cases and settings (4.1, 4.3, 4.4, appendix B), their motions, and the kind of each motion.

F (4.1) has three kinds: periodic; transient chaos, "a significant period well beyond what would be typically
considered as transient" and then periodic; chaos "sustained over at least 1000 crank cycles". F does not give
the starts, so that a kind is that of most of some random ones.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np

from models.slider_crank.motions.classification import (
    CHAOTIC,
    PERIODIC,
    TRANSIENT_CHAOS,
    Classification,
    classify,
)
from models.slider_crank.motions.histories import ONSET
from models.slider_crank.motions.machine import Events, Machine, Motion
from models.slider_crank.motions.transients import Transients, draw_starts, measure_transients

# Appendix B: cycles before data is taken, cycles of data, and the rebound below which the roller slides.
TRANSIENT, CYCLES, THRESHOLD = 30, 3000, 0.005
# F 4.1: chaos is what is sustained so long (cycles).
SUSTAINED = 1000
GAPS = (0.01, 0.015, 0.02)
LOW_DAMPINGS, HIGH_DAMPINGS = (0.025, 0.05, 0.075), (0.15, 0.20, 0.25)
MATRIX = (*LOW_DAMPINGS, *HIGH_DAMPINGS)
PUBLISHED, CORRECTED = "as_published", "corrected"
FORMS = (PUBLISHED, CORRECTED)
# Cycles in which a repetition is sought: several times what F recorded.
SOUGHT = 20_000
# Random starts over which statements about transients are judged, and cycles of each.
STARTS = 24
STARTS_SOUGHT = 6000
# Longer periods are not seen as such in a figure.
LONGEST_SEEN = 8
# Chaos within so much of the gap looks periodic in F's figures.
NARROW = 0.02
# More than this share of the starts makes a kind.
MOST = 0.5


@dataclass(frozen=True)
class Case:
    """A point of F's parameter space, in one form of the equations; `threshold` 0 is the exact limit."""

    damping: float
    gap: float
    restitution: float = 0.9
    form: str = PUBLISHED
    threshold: float = 0.0

    @cached_property
    def machine(self) -> Machine:
        return Machine(self.damping, self.gap, self.restitution, self.form, sliding_threshold=self.threshold)

    def in_form(self, form: str) -> Case:
        return replace(self, form=form)

    @property
    def by_thesis_rule(self) -> Case:
        """With F's rule for the beginning of sliding (appendix B)."""
        return replace(self, threshold=THRESHOLD)

    def __str__(self) -> str:
        words = f"({self.damping:g}, {self.gap:g})"
        return words if self.restitution == 0.9 else f"{words}, e = {self.restitution:g}"


def list_cases(dampings: tuple[float, ...], form: str = PUBLISHED, restitution: float = 0.9) -> list[Case]:
    """F's cases for these dampings, row by row."""
    return [Case(damping, gap, restitution, form) for damping in dampings for gap in GAPS]


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

    def _band(self, case: Case) -> tuple[int, float]:
        """The shortest period that a motion keeps within NARROW, or else that of at most LONGEST_SEEN cycles
        that it keeps best, and the largest change of psi from one period to the next, over the gap."""
        psi = self.motion(case, 10 * TRANSIENT).strobe(1000)[:, 0]
        changes = {p: float(np.abs(psi[p:] - psi[:-p]).max()) / case.gap for p in range(1, LONGEST_SEEN + 1)}
        best = min(changes, key=lambda p: changes[p])
        period = next((p for p, change in changes.items() if change < NARROW), best)
        return period, changes[period]

    def _sliding_share(self, case: Case) -> float:
        """Share of the time during which the roller slides."""
        _, states = self.motion(case).trace(cycles=200, points=200)
        return float(np.mean(states[:, 2] != 0.0))

    def _orbit_slides(self, case: Case, start: int) -> bool:
        """True if there is sliding in the orbit on which this one of the random starts settles."""
        found = self.settling(case)
        motion = Motion(case.machine, *found.starts[start]).skip(int(found.lengths[start]) + TRANSIENT)
        begins = motion.events(int(found.periods[start])).kind == ONSET
        return bool(begins.any() or motion.strobe(1)[0, 2] != 0.0)


@dataclass(frozen=True)
class Observed:
    """`sliding`: from some start the motion slides in the end. `words`: the kind with its evidence."""

    kind: str
    sliding: bool
    words: str


def observe(runs: Runs, case: Case) -> Observed:
    """The kind that most of the random starts show. A start is periodic if its motion settles within
    STARTS_SOUGHT cycles, with a period below SUSTAINED."""
    found = runs.settling(case)
    regular = found.settled & (found.periods < SUSTAINED)
    share, median = float(regular.mean()), float(np.median(found.lengths))
    if share <= MOST:
        return Observed(CHAOTIC, runs.kind(case).slides, _describe_irregular(runs, case, share))
    orbits = sorted(
        {(int(found.periods[n]), runs.orbit_slides(case, int(n))) for n in np.flatnonzero(regular)}
    )
    named = ", ".join(f"{period}{' with sliding' if slides else ''}" for period, slides in orbits)
    least, most = int(found.lengths[regular].min()), int(found.lengths[regular].max())
    kind = TRANSIENT_CHAOS if median > TRANSIENT else PERIODIC
    words = f"{kind}: period {named}, after {least} to {most} cycles, median {median:.0f}"
    if share < 1.0:
        words += f" ({100 * share:.0f} % of the starts within {STARTS_SOUGHT})"
    return Observed(kind, any(slides for _, slides in orbits), words)


def _describe_irregular(runs: Runs, case: Case, share: float) -> str:
    kind = runs.kind(case)
    if kind.slides:
        orbit = f"period {kind.period}" if kind.period else "a period beyond what was looked at"
        words = f"irregular, but exactly periodic as it slides ({orbit})"
    else:
        words = f"chaotic: exponent {kind.exponent:.3f} ± {max(kind.uncertainty, 5e-4):.3f} per rad"
        period, width = runs.band(case)
        if width < NARROW:
            words += f", but within {100 * width:.1f} % of the gap of period {period}"
    if share:
        words += f"; {100 * share:.0f} % of the starts settle within {STARTS_SOUGHT} cycles"
    return words
