"""`python -m reproduction farahanchi1991`: F's figures 2.2 to 4.44 and its statements.

F: Faramarz Farahanchi, "Chaotic and Periodic Dynamics of a Slider Crank Mechanism with Slider Clearance",
M.S. thesis, Michigan State University (1991).
"""

from __future__ import annotations

from collections.abc import Sequence

from .. import table
from ..publication import FIGURES, Publication
from ..statement import Statement
from . import engineer, figures
from .runs import STARTS, STARTS_SOUGHT, Runs
from .statements import CLAIMS

INTRODUCTION = f"""\
# Farahanchi (1991), reproduced

*Chaotic and Periodic Dynamics of a Slider Crank Mechanism with Slider Clearance*, M.S. thesis, Michigan
State University (F). The command draws figures 2.2 and 2.4 to 4.44 and judges the statements of the thesis,
with its own equation of motion and with the corrected one.

**The error.** F's rod has the angle φ − ψ, but its kinetic energy is written with φ̇ + ψ̇. As a result, the
forcing term has −β instead of +β: for F's engine a factor of 1.003 instead of 1.947. All results are
affected. Only (2.27) is printed with the right sign. `as_published` follows F; `corrected` differs in this
sign alone.

**Method.** Exact flow between impacts, impacts as roots, bounces to their limit point, no threshold. F
integrates with a step of 0.005 and lets the roller slide as soon as it rebounds with less than 0.005; the
table says where this changes a verdict. As in F, records are 3000 cycles after 30; e = 0.9 unless stated. F
does not give its start values: records start at ψ = ψ' = 0. The kind of a motion is that of most of
{STARTS} random starts, each followed for {STARTS_SOUGHT} cycles; a transient of up to 30 cycles does not
count ([motions](theory/motions.md)).

**Verdicts.** *Met*; *not met*; *cannot be met* where F contradicts itself; *cannot be checked* where the
data is missing. Both columns judge F's words, the first by F's equation, the second by the corrected one.
No number is fitted to F's.

Impact distributions show velocities of approach, summed over the impacts and divided by the number of
cycles rather than of impacts (F (3.6)).

`python -m reproduction farahanchi1991 --out FOLDER` writes this page and its figures. After a change of the
models, copy `farahanchi1991.md` and the figures that it shows to `docs`.
"""
# Of all figures the page shows these; F's numbers.
SHOWN = {
    "2.4": "At high speed the wall force changes its sign four times a cycle",
    "2.10": "Where the slider stays on the upper wall for good",
    "4.3": "F's strange attractor, and what the right sign makes of it",
    "4.6": "Transient chaos: spikes on a background; chaos with the right sign",
    "4.25": "Low speed: impacts as published, rest with the right sign",
    "4.44": "e = 0.5: sliding",
}


def format_page(runs: Runs, statements: Sequence[Statement]) -> str:
    """The Markdown page: introduction, what it means, figures, table."""
    parts = [INTRODUCTION, engineer.format_section(runs), "## Figures\n"]
    parts.append(f"The command draws {len(figures.PICTURES)}; six of them:\n")
    for picture in figures.PICTURES:
        if picture.number in SHOWN:
            name = f"{FIGURES}/{figures.PREFIX}{picture.file}"
            parts.append(f"![Fig. {picture.number}: {SHOWN[picture.number]}]({name})\n")
    parts += ["## Statements\n", f"{table.count_verdicts(statements)}.\n", table.format_rows(statements), ""]
    return "\n".join(parts)


PUBLICATION = Publication(
    name="farahanchi1991",
    runs=Runs,
    claims=CLAIMS,
    figures=[figures.PREFIX + picture.file for picture in figures.PICTURES],
    draw=figures.draw,
    page=format_page,
)
