"""`python -m reproduction farahanchi1991`: F's figures 2.2 to 4.44 and its statements.

F: Faramarz Farahanchi, "Chaotic and Periodic Dynamics of a Slider Crank Mechanism with Slider Clearance",
M.S. thesis, Michigan State University (1991).
"""

from ..publication import Publication
from .chapters_1_to_3 import CLAIMS as CHAPTERS_1_TO_3
from .chapters_4_and_5 import CLAIMS as CHAPTERS_4_AND_5
from .figures import FIGURES
from .runs import STARTS, STARTS_SOUGHT, Runs

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

**Verdicts.** *Met*; *not met*; *cannot be met* where F contradicts itself. Both columns judge F's words, the
first by F's equation, the second by the corrected one. No number is fitted to F's.

Impact distributions show velocities of approach, summed over the impacts and divided by the number of
cycles rather than of impacts (F (3.6)).

`python -m reproduction farahanchi1991 --out FOLDER` writes this page and its figures. After a change of the
models, copy `farahanchi1991.md` and the figures that it shows to `docs`.
"""
# F's statements that can be computed or contradict another, in F's order.
CLAIMS = (*CHAPTERS_1_TO_3, *CHAPTERS_4_AND_5)


def format_sections(runs: Runs) -> list[str]:
    """The page's parts before the statements."""
    shown = [figure.markdown for figure in FIGURES if figure.caption]
    return [
        "## Figures\n",
        f"The command draws {len(FIGURES)}; six of them:\n",
        *shown,
    ]


PUBLICATION = Publication("farahanchi1991", Runs, CLAIMS, FIGURES, INTRODUCTION, format_sections)
