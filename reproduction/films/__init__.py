"""`python -m reproduction films`: published film formulas judged by the numerical line contact.

Through the cam cycle of the valve train at several speeds, transient and steady, and over the ranges of
Kushwaha's Table 3.
"""

from ..publication import Publication
from .cam import NODES
from .figures import FIGURES
from .numerical import TOLERANCE
from .runs import STEP_DEG, Runs
from .statements import CLAIMS

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

`python -m reproduction films --out FOLDER` writes this page and its figures. After a change of the
models, copy `films.md` and the figures to `docs`.
"""
IN_SHORT = """\
## In short

- Kushwaha's (10) as printed is near the steady film inside Table 3 and up to twice as thick outside. Between
  nearly rigid bodies it is too thin, as it does not fall as 1/W. With the other sign of the load it is
  several times too thick.
- In most of the event the contact is outside the conditions of power laws. There those of the central film
  are up to a quarter too thick; those of the minimum film hold all the same.
- No steady film describes the cam contact: it is right in less than three quarters of the event, and 0 at the
  reversals, where squeeze keeps a film.
"""


def format_sections(runs: Runs) -> list[str]:
    """The page's parts before the statements."""
    cycle, sample = (figure.markdown for figure in FIGURES)
    return [IN_SHORT, "## Through the cam's event\n", cycle, "## Over Table 3\n", sample]


PUBLICATION = Publication("films", Runs, CLAIMS, FIGURES, INTRODUCTION, format_sections, Runs.solve)
