"""The table of the films through the cam cycle, by speed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from models.core.quantities import Vector

from ..kushwaha2000.runs import NOSE_DEG
from ..table import format_table
from .cam import CamCycle
from .formulas import CENTRAL, MINIMUM
from .runs import Runs

MICRO = 1e6


def format_speeds(runs: Runs) -> str:
    """A Markdown table: the transient film, then each other film over it, in a column for each speed."""
    speeds = [f"{c.speed_rpm:.0f} r/min" for c in runs.cycles]
    rows = []
    for words, film, cell in NUMBERS:
        rows.append([words, film, *(cell(c) for c in runs.cycles)])
    for name, judged in runs.cycles[0].judged.items():
        rows.append(
            [f"{judged.words} / transient", judged.film, *(format_ratio(c, name) for c in runs.cycles)]
        )
    return format_table(["", "Film", *speeds], *rows)


def format_ratio(c: CamCycle, name: str) -> str:
    """Ratio at the nose; median over the event; at the reversals; share outside the conditions."""
    ratio = c.ratio(name)
    outside = 100.0 * float(np.mean(~c.judged[name].valid))
    share = f"{outside:.0f} %"
    parts = (
        f"{ratio[c.at(NOSE_DEG)]:.2f}",
        f"{np.nanmedian(ratio):.2f}",
        format_span(ratio[c.reversals]),
        share,
    )
    return "; ".join(parts)


def format_span(values: Vector) -> str:
    """Least and largest, 0 where no film is steady."""
    low, high = (float(f(np.nan_to_num(values))) for f in (np.min, np.max))
    return "0" if high < 0.005 else f"{low:.2f}-{high:.2f}"


def _nose(film: str) -> Callable[[CamCycle], str]:
    return lambda c: f"{MICRO * c.transient[film][c.at(NOSE_DEG)]:.3f}"


def _reversals(c: CamCycle) -> str:
    return ", ".join(f"{MICRO * c.transient[MINIMUM][k]:.3f}" for k in c.reversals)


def _least(c: CamCycle) -> str:
    film, angle = c.least
    return f"{MICRO * film:.3f} at {angle:.1f}°"


def _groups(c: CamCycle) -> str:
    M, L = (values[np.isfinite(values)] for values in (c.M, c.L))
    return f"{M.min():.1f}-{M.max():.0f}; {L.min():.0f}-{L.max():.0f}"


NUMBERS: tuple[tuple[str, str, Callable[[CamCycle], str]], ...] = (
    ("transient numerical, at the nose [µm]", CENTRAL, _nose(CENTRAL)),
    ("the same", MINIMUM, _nose(MINIMUM)),
    ("at the four reversals [µm]", MINIMUM, _reversals),
    ("least of the event [µm], cam angle", MINIMUM, _least),
    ("Moes' M; L away from the reversals", "", _groups),
)
