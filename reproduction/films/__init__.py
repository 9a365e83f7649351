"""`python -m reproduction films`: published film formulas judged by the numerical line contact.

Through the cam cycle of the valve train at several speeds, transient and steady, and over the ranges of
Kushwaha's Table 3.
"""

from ..publication import Publication
from .cam import NODES
from .figures import FIGURES, NUMBERS
from .numerical import TOLERANCE
from .runs import STEP_DEG, Runs
from .statements import CLAIMS
from .text import format_speeds, summarise

INTRODUCTION = f"""\
# Published film formulas, judged

Published film formulas for line contacts, compared with the numerical solution (Roelands viscosity,
Dowson-Higginson density):

1. *Through the cam event of the valve train*, with load and speed of the monolithic solution in adherence
   form with spring surge. The *transient* solution includes squeeze ({NODES} nodes, steps of 0.1°, error
   control). The *steady* solution, every {STEP_DEG:g}°, is that for the load, speed and curvature of the
   instant (accurate to {100.0 * TOLERANCE:g} %).
2. *Over the ranges of Kushwaha's Table 3*: contacts sampled by scrambled Sobol' points with a fixed seed,
   both steady and with bodies that approach each other uniformly, as in the quasi-static solutions behind
   his formula.

A formula is inside its conditions where its author's ranges hold. For Kushwaha's these are the stated
ranges; for power laws the contact is elastic-piezoviscous, as told by the asymptotes of Martin, Blok and
Moes. *Squeezed* is Kushwaha's formula with its squeeze term, in the contact's relaxation equation. The
others have no squeeze term and give no film without entrainment.

`python -m reproduction films --out FOLDER` writes this page, its figures and tables. After a change of the
models, copy `films.md` and the figures to `docs`.
"""
BY_SPEED = """\
## By speed

The transient film, then all others over it, four numbers at each speed: at the nose; median over the event;
at the reversals (0: no film without squeeze); share of the event outside its conditions.
"""


def format_sections(runs: Runs) -> list[str]:
    """The page's parts before the statements."""
    cycle, field, *over = (figure.markdown for figure in FIGURES)
    return [
        "## In short\n", summarise(runs),
        "## Through the cam's event\n", cycle, BY_SPEED, format_speeds(runs), "",
        "## Across the contact\n", field,
        "## Over Table 3\n", *over,
    ]  # fmt: skip


PUBLICATION = Publication(
    "films", Runs, CLAIMS, [*FIGURES, *NUMBERS], INTRODUCTION, format_sections, Runs.solve
)
