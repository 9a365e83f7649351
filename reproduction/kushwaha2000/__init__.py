"""`python -m reproduction kushwaha2000`: Figs 2 to 8 and every quantitative statement of the source.

Kushwaha, Rahnejat and Jin, "Valve-train dynamics: a simplified tribo-elasto-multi-body analysis", Proc.
Instn Mech. Engrs 214 K (2000).
"""

from ..publication import Publication
from .figures import FIGURES
from .runs import Runs
from .statements import CLAIMS

INTRODUCTION = """\
# Kushwaha, Rahnejat and Jin (2000), reproduced

*Valve-train dynamics: a simplified tribo-elasto-multi-body analysis*, Proc. Instn Mech. Engrs 214 K. This
page shows Figs 2 to 8 as computed by the models of this project, and judges every quantitative statement of
the paper:

- *met* or *not met*;
- *cannot be met*: the statement contradicts others of the paper, or the equation as printed has no sensible
  solution.

Values that the paper does not give (lift, preload, steel, lubricant, spring damping, shaft) were chosen
once, as the defaults of the components (parameter set `kushwaha2000`). No value was fitted to the paper's
results. Statements about other authors' cams and measurements are left out.

All runs are the scenario `valve-train` in adherence form (the follower stays on the cam, as in the paper),
in the steady state. Speeds are those of the camshaft. The film follows (10) with its squeeze term, as the
differential equation dh/dt = −(|u|/96.775) ln(h/h_ss). The load exponent of (10) is printed as +0.059,
where physics requires −0.059. Both are shown where they matter; elsewhere the printed one applies.

`python -m reproduction kushwaha2000 --out FOLDER` writes this page and its figures. After a change of the
models, copy `kushwaha2000.md` and `figures` to `docs`.
"""


def format_sections(runs: Runs) -> list[str]:
    """The page's parts before the statements."""
    return ["## Figures\n", *(figure.markdown for figure in FIGURES)]


PUBLICATION = Publication("kushwaha2000", Runs, CLAIMS, FIGURES, INTRODUCTION, format_sections)
