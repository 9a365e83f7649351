"""`python -m reproduction films`: published film formulas judged by the numerical line contact.

Through the cam cycle of the valve train at several speeds, transient and steady, and over the ranges of
Kushwaha's Table 3; and power laws fitted anew over those ranges.
"""

from __future__ import annotations

from collections.abc import Sequence

from .. import table
from ..publication import FIGURES, Publication
from ..statement import Statement
from . import figures
from .across import text
from .cam import NODES
from .cycle_table import by_speed
from .in_short import in_short
from .numerical import TOLERANCE
from .runs import STEP_DEG, Runs
from .statements import CLAIMS

INTRODUCTION = f"""\
# Film formulas, judged

The published formulas for the film of a line contact against its numerical solution (Roelands viscosity,
Dowson-Higginson density). First through the cam's event of the valve train, with load and speed of the
monolithic solution in adherence form with spring surge: against the *transient* film, which squeezing keeps
up where entrainment reverses ({NODES} nodes, steps of 0.1° with error control), and every {STEP_DEG:g}°
against the *steady* one (right to {100.0 * TOLERANCE:g} %), which load, speed and curvature of that instant
would keep up. Then at contacts sampled over the ranges of Kushwaha's Table 3 (scrambled Sobol' points,
explicit seeds), steady and with bodies that close evenly, as in the quasi-static solutions behind his
formula. Last, power laws of two groups fitted to one sample and judged by another.

Kushwaha's formula is inside its validity where its stated ranges hold, the power laws where the contact is
elastic-piezoviscous, as their authors' were: by the asymptotes of Martin, Blok and Moes in M and L, of which
the largest rules, with the lower of the two piezoviscous ones. *Squeezed* is Kushwaha's formula with its
squeeze term, as the contact's relaxation; the others have none, and are 0 where no oil is entrained.

`python -m reproduction films --out FOLDER` writes this page, its figures and tables; after a change of the
models, copy `films.md` and the figures from the folder to `docs`.
"""
BY_SPEED = """\
## By speed

The transient film, then all others over it, four numbers at each speed: at the nose; median over the event;
at the reversals (0: no film without squeeze); share of the event outside its conditions.
"""


def page(runs: Runs, statements: Sequence[Statement]) -> str:
    """The Markdown page: introduction, figures, tables."""
    pictures = {name: f"![{caption}]({FIGURES}/{name}.png)\n" for name, caption in figures.CAPTIONS.items()}
    across = ["## Across the contact\n", pictures.pop(figures.FIELD), text(runs.shown)]
    cycle = ["## Through the cam's event\n", pictures.pop(figures.CYCLE)]
    over = ["## Over Table 3\n", *pictures.values()]
    verdicts = ["## Verdicts\n", f"{table.tally(statements)}.\n", table.markdown(statements), ""]
    brief = ["## In short\n", in_short(runs)]
    return "\n".join([INTRODUCTION, *brief, *cycle, BY_SPEED, by_speed(runs), "", *across, *over, *verdicts])


PUBLICATION = Publication(
    name="films",
    runs=Runs,
    claims=CLAIMS,
    figures=figures.FILES,
    draw=figures.draw,
    page=page,
    solve=Runs.solve,
)
