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
State University (F): its figures 2.2 and 2.4 to 4.44 drawn, and its statements judged, each as published
and with the right sign.

**The error.** F's rod has the angle φ − ψ, but its kinetic energy is written with φ̇ + ψ̇. That puts −β
for +β into the forcing of the equation of motion, for F's engine a factor 1.003 for 1.947, and into every
result. F prints the right equation once, as (2.27), without using it. `as_published` follows F;
`corrected` differs in this sign alone.

**How it is computed.** Motions between impacts by their exact flow, impacts as roots, bounces to their
limit; no threshold. F integrates with a step of 0.005 and lets the roller slide as soon as it rebounds
with less than 0.005: where that changes a verdict it is said. As F does, records are 3000 cycles after
30; e = 0.9 where nothing is said. F does not give its starts. Records begin at ψ = ψ' = 0; whether a
motion is chaotic (for F: at least 1000 cycles), transiently chaotic or periodic is judged by most of
{STARTS} random starts, each followed for {STARTS_SOUGHT} cycles, a transient of up to 30 cycles counting
as none. A motion that slides again and again is exactly periodic in the end, as it is released at a fixed
angle from rest on the wall, but chaos between the slides can make its period hundreds or thousands of
cycles long, and rounding decides how long.

**Verdicts**: *met*; *not met*; *cannot be met* where F contradicts itself; *cannot be checked* where what
it needs is not here. Both columns judge F's words, the first by F's equation, the second by the right
one. No number is typed in or tuned to F's.

Impact distributions are drawn with velocities of approach to the wall, summed over the impacts and
divided by the cycles, not by the impacts (F (3.6)): see the table.

This page and its figures are written by `python -m reproduction farahanchi1991 --out FOLDER`; after a
change of the models, copy `farahanchi1991.md` and, of `figures`, those that it shows to `docs`.
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


def page(runs: Runs, statements: Sequence[Statement]) -> str:
    """The Markdown page: introduction, what it means, figures, table."""
    parts = [INTRODUCTION, engineer.section(runs), "## Figures\n"]
    parts.append(f"The command draws {len(figures.PICTURES)}; six of them:\n")
    for picture in figures.PICTURES:
        if picture.number in SHOWN:
            name = f"{FIGURES}/{figures.PREFIX}{picture.file}"
            parts.append(f"![Fig. {picture.number}: {SHOWN[picture.number]}]({name})\n")
    parts += ["## Statements\n", f"{table.tally(statements)}.\n", table.markdown(statements), ""]
    return "\n".join(parts)


PUBLICATION = Publication(
    name="farahanchi1991",
    runs=Runs,
    claims=CLAIMS,
    figures=[figures.PREFIX + picture.file for picture in figures.PICTURES],
    draw=figures.draw,
    page=page,
)
