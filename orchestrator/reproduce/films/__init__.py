"""`tribocosim reproduce films`: published film formulas judged by the steady numerical line contact.

Through the cam cycle of the valve train at several speeds, and over the ranges of Kushwaha's Table 3; and
power laws fitted anew over those ranges.
"""

from __future__ import annotations

from collections.abc import Sequence

from .. import table
from ..publication import FIGURES, Publication
from ..statement import Statement
from . import figures
from .runs import STEP_DEG, Runs
from .statements import CHECKS, by_speed

INTRODUCTION = f"""\
# Film formulas, judged

The published formulas for the film of a line contact against its steady numerical solution (Roelands
viscosity, Dowson-Higginson density, right to 0.2 %). First through the cam's event of the valve train, every
{STEP_DEG:g}°, with load and speed of the monolithic solution in adherence form with spring surge. Then at
contacts sampled over the ranges of Kushwaha's Table 3 (scrambled Sobol' points, explicit seeds), steady and
with bodies that close evenly, as in the quasi-static solutions behind his formula. Last, power laws of two
groups fitted to one sample and judged by another.

All films here are steady: at each angle, the one that load, speed and curvature would keep up. Where
entrainment reverses (gaps in the figure) that film tends to zero, and the real one, which squeezing keeps up,
is the transient solution's. Kushwaha's formula is inside its validity where its stated ranges hold, the power
laws where the contact is elastic-piezoviscous, as their authors' were: by the asymptotes of Martin, Blok and
Moes, of which the largest rules, with the lower of the two piezoviscous ones. Ratios are formula over
numerical film.

This page, its figures and tables are written by `tribocosim reproduce films --out FOLDER`; after a change of
the models, copy `films.md` and the figures from the folder to `docs`.
"""


def page(runs: Runs, statements: Sequence[Statement]) -> str:
    """The Markdown page: introduction, figures, tables."""
    parts = [INTRODUCTION]
    parts += [f"![{caption}]({FIGURES}/{name}.png)\n" for name, caption in figures.CAPTIONS.items()]
    parts += [
        "## By speed\n",
        "Formula over numerical film in the event, where its conditions hold and elsewhere.\n",
    ]
    parts += [
        by_speed(runs),
        "",
        "## Verdicts\n",
        f"{table.tally(statements)}.\n",
        table.markdown(statements),
        "",
    ]
    return "\n".join(parts)


PUBLICATION = Publication(
    name="films",
    runs=Runs,
    checks=CHECKS,
    figures=figures.FILES,
    draw=figures.draw,
    page=page,
)
