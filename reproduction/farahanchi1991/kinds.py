"""What a motion is, by F's own measures, over many starts.

F (4.1): periodic; transient chaos, "a significant period well beyond what would be typically considered as
transient" and then periodic; chaos "sustained over at least 1000 crank cycles". F does not give its starts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.slider_crank.motions.classification import CHAOTIC, PERIODIC, TRANSIENT_CHAOS

from .cases import SUSTAINED, TRANSIENT, Case
from .runs import NARROW, STARTS_SOUGHT, Runs

__all__ = ["CHAOTIC", "PERIODIC", "TRANSIENT_CHAOS", "Observed", "observe"]
# More than this share of the starts makes a kind.
MOST = 0.5


@dataclass(frozen=True)
class Observed:
    """kind: by the starts. settled: share of them that become periodic, with a period below SUSTAINED, within
    the time looked at. median: cycles until then. sliding: from some start, the motion slides in the end."""

    kind: str
    settled: float
    median: float
    sliding: bool
    words: str


def observe(runs: Runs, case: Case) -> Observed:
    """The kind that most of the random starts show, in words with its evidence."""
    found = runs.settling(case)
    regular = found.settled & (found.periods < SUSTAINED)
    share, median = float(regular.mean()), float(np.median(found.lengths))
    if share <= MOST:
        return Observed(CHAOTIC, share, median, runs.kind(case).slides, _irregular(runs, case, share))
    orbits = sorted(
        {(int(found.periods[n]), runs.orbit_slides(case, int(n))) for n in np.flatnonzero(regular)}
    )
    named = ", ".join(f"{period}{' with sliding' if slides else ''}" for period, slides in orbits)
    least, most = int(found.lengths[regular].min()), int(found.lengths[regular].max())
    kind = TRANSIENT_CHAOS if median > TRANSIENT else PERIODIC
    words = f"{kind}: period {named}, after {least} to {most} cycles, median {median:.0f}"
    if share < 1.0:
        words += f" ({100 * share:.0f} % of the starts within {STARTS_SOUGHT})"
    return Observed(kind, share, median, any(slides for _, slides in orbits), words)


def _irregular(runs: Runs, case: Case, share: float) -> str:
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
