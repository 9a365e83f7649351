"""Six of F's figures, by its numbers: an analysis of each case in both forms of the equations."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from orchestrator.analyses import load

from ..publication import Drawing
from .runs import CYCLES, FORMS, TRANSIENT, Case, Runs

DPI = 80.0
EXAMPLE = Case(0.05, 0.01)
RECORD = {"cycles": CYCLES, "transient": TRANSIENT}
PATTERN = RECORD | {"velocity": "approach", "per": "cycle"}
# F's magnifications need more points than its 3000 cycles give.
MAGNIFIED = RECORD | {"cycles": 60_000}
TRACE = {"cycles": 3, "transient": TRANSIENT}


@dataclass(frozen=True)
class Picture:
    """A figure of F: "4.6", the analysis that draws it, its case, and what else the analysis is given."""

    number: str
    analysis: str
    case: Case
    given: Mapping[str, Any] = field(default_factory=dict)

    @property
    def file(self) -> str:
        chapter, figure = self.number.split(".")
        return f"farahanchi1991-fig-{chapter}.{figure.zfill(2)}-{self.analysis}.png"

    def draw(self, form: str) -> Any:
        """The analysis in one form of the equations, as pixels."""
        analysis: Any = load(self.analysis)  # all of these have a table and a figure
        case = self.case.in_form(form)
        of_case = {name: getattr(case, name) for name in ("damping", "gap", "restitution", "form")}
        known = {name: value for name, value in of_case.items() if name in analysis.parameters}
        values = analysis.complete({**known, **self.given})
        figure = analysis.draw(analysis.table(values), values)
        figure.set_dpi(DPI)
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())

    def plot(self, runs: Runs) -> Figure:
        """As published above, corrected below."""
        above, below = (self.draw(form) for form in FORMS)
        height, width = len(above) + len(below), max(above.shape[1], below.shape[1])
        figure = Figure((width / DPI, height / DPI), dpi=DPI)
        figure.figimage(above, 0, len(below), origin="upper")
        figure.figimage(below, 0, 0, origin="upper")
        return figure


PICTURES = {
    "Fig. 2.4: At high speed the wall force changes its sign four times a cycle": Picture(
        "2.4", "force", Case(0.01, 0.01)
    ),
    "Fig. 2.10: Where the slider stays on the upper wall for good": Picture(
        "2.10", "regions", EXAMPLE, {"largest_gap": 0.02, "points": 21}
    ),
    "Fig. 4.3: F's strange attractor, and what the right sign makes of it": Picture(
        "4.3", "poincare", EXAMPLE, MAGNIFIED
    ),
    "Fig. 4.6: Transient chaos: spikes on a background; chaos with the right sign": Picture(
        "4.6", "profile", Case(0.025, 0.01), PATTERN
    ),
    "Fig. 4.25: Low speed: impacts as published, rest with the right sign": Picture(
        "4.25", "profile", Case(0.15, 0.015), PATTERN
    ),
    "Fig. 4.44: e = 0.5: sliding": Picture("4.44", "trace", Case(0.05, 0.02, 0.5), TRACE),
}
FIGURES = [Drawing[Runs](picture.file, picture.plot, caption, DPI) for caption, picture in PICTURES.items()]
