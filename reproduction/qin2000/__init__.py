"""`python -m reproduction qin2000`: every statement of the source on valve trains and their models.

Qin and Zuo, "Multibody system dynamics analysis for valve trains", Journal of Beijing Institute of Technology
9 (2000) 375-379.
"""

from ..publication import Publication
from .runs import FIGURES, Runs
from .statements import CLAIMS

INTRODUCTION = """\
# Qin and Zuo (2000), judged

*Multibody system dynamics analysis for valve trains*, Journal of Beijing Institute of Technology 9 (2000)
375-379: finite segments for slender parts, rigid bodies for the others, and a pushrod train of the diesel
engine 4100QB as an example. This page judges its statements on valve trains and their models, *met* or *not
met*.

The paper prints no geometry, mass, stiffness or cam of the example, and its figures cannot be read in our
copy: what it says of the example's loads, stresses, landing and lubrication is left out.
Numbers are therefore those of the shipped scenarios `qin2000-train`, with parts of that size, and
`exhaust-valve`, whose gas is that of a petrol engine at full load (4.9 MPa at most); the source gives no
pressures and no phases. Nothing was fitted. Speeds are those of the camshaft; 1600 r/min is near the rated
speed of such an engine. Cycles are steady, from the equations of the whole train.
`tribocosim analyse cam` computes the ample factor of a cam's lift and the slope of its lubrication
characteristic.

`python -m reproduction qin2000 --out FOLDER` writes this page and its figure. After a change of the models,
copy `qin2000.md` and `figures` to `docs`.
"""


def format_sections(runs: Runs) -> list[str]:
    """The page's parts before the statements."""
    return ["## The train at low and at high speed\n", *(figure.markdown for figure in FIGURES)]


PUBLICATION = Publication("qin2000", Runs, CLAIMS, FIGURES, INTRODUCTION, format_sections)
