"""`python -m reproduction kushwaha2000`: Figs 2 to 8 and every quantitative statement of the source.

Kushwaha, Rahnejat and Jin, "Valve-train dynamics: a simplified tribo-elasto-multi-body analysis", Proc.
Instn Mech. Engrs 214 K (2000).
"""

from __future__ import annotations

from collections.abc import Sequence

from .. import table
from ..publication import FIGURES, Publication
from ..statement import Statement
from . import figures
from .runs import Runs
from .statements import CLAIMS

INTRODUCTION = """\
# Kushwaha, Rahnejat and Jin (2000), reproduced

*Valve-train dynamics: a simplified tribo-elasto-multi-body analysis*, Proc. Instn Mech. Engrs 214 K: Figs
2 to 8 drawn from the models of this project, and every quantitative statement of the paper with the
computed value and a verdict: *met*; *not met*; *cannot be met* where the statement contradicts the
paper's others, or the equation as printed has no sensible solution. No number here is typed in or tuned
to the paper's results. What the paper does not give (lift, preload, steel, lubricant, spring damping,
shaft) was chosen once; it is the parameter set `kushwaha2000`, the defaults of the components. Statements
about other authors' cams and measurements are left out.

All runs are the shipped scenario `valve-train` in adherence form (the follower held to the cam, as in the
paper), in the steady state. Speeds are those of the camshaft. The film follows (10) with its squeeze
term, read as the differential equation dh/dt = −(|u|/96.775) ln(h/h_ss). The load exponent of (10) is
+0.059 in print, where physics wants −0.059: both are shown where it matters, and the printed one is meant
where nothing is said.

This page and its figures are written by `python -m reproduction kushwaha2000 --out FOLDER`; after a change
of the models, copy `kushwaha2000.md` and `figures` from the folder to `docs`.
"""


def page(runs: Runs, statements: Sequence[Statement]) -> str:
    """The Markdown page: introduction, figures, table."""
    parts = [INTRODUCTION, "## Figures\n"]
    for number, (_, caption) in figures.FIGURES.items():
        parts.append(f"![Fig. {number}: {caption}]({FIGURES}/{figures.PREFIX}{number}.png)\n")
    parts += ["## Statements\n", f"{table.tally(statements)}.\n", table.markdown(statements), ""]
    return "\n".join(parts)


PUBLICATION = Publication(
    name="kushwaha2000",
    runs=Runs,
    claims=CLAIMS,
    figures=[f"{figures.PREFIX}{number}.png" for number in figures.FIGURES],
    draw=figures.draw,
    page=page,
)
