"""F's figures from 2.2 to 4.44, by its numbers: an analysis of each case in both forms of the equations.

2.1, 2.3, A.1 and B.1 are sketches; 3.1 shows the motion of 4.2 in space. The magnifications 4.4 and 4.5 stand
beside their map 4.3, and the spectra of both walls (4.16 and 4.17, 4.19 and 4.20, 4.22 and 4.23) together.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from orchestrator.analyses import load

from ..publication import Drawing
from .runs import CYCLES, FORMS, HIGH_DAMPINGS, LOW_DAMPINGS, TRANSIENT, Case, Runs, list_cases

DPI = 80.0
EXAMPLE = Case(0.05, 0.01)
RECORD = {"cycles": CYCLES, "transient": TRANSIENT}
PATTERN = RECORD | {"velocity": "approach", "per": "cycle"}
# Both magnifications need more points than F's 3000 cycles give.
MAGNIFIED = RECORD | {"cycles": 60_000}
TRACE = {"cycles": 3, "transient": TRANSIENT}
EARLY = {"cycles": 2, "transient": 25}
# The damping that F's text gives for Figs 4.40 and 4.41, whose captions have 0.025.
TEXT_DAMPING = 0.05


@dataclass(frozen=True)
class Picture:
    """A figure of F: "4.6", the analysis that draws it, its case, and what else the analysis is given."""

    number: str
    analysis: str
    case: Case = EXAMPLE
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


def list_patterns(first: int, dampings: tuple[float, ...]) -> list[Picture]:
    """F's 3 x 3 distribution patterns."""
    cases = enumerate(list_cases(dampings), first)
    return [Picture(f"4.{n}", "profile", case, PATTERN) for n, case in cases]


def list_spectra(first: int, case: Case) -> list[Picture]:
    """Map and spectra of a case."""
    return [
        Picture(f"4.{first}", "poincare", case, RECORD),
        Picture(f"4.{first + 1}", "spectrum", case, PATTERN),
    ]


PICTURES: tuple[Picture, ...] = (
    Picture("2.2", "trace", EXAMPLE, {"cycles": 1}),
    Picture("2.4", "force", Case(0.01, 0.01)),
    Picture("2.5", "force", Case(0.1, 0.01)),
    Picture("2.6", "force", Case(0.25, 0.01)),
    Picture("2.7", "force", Case(0.267, 0.02)),
    Picture("2.8", "force", Case(0.1, 0.01), {"start": 3.5, "end": 3.9}),
    Picture("2.9", "force", Case(0.35, 0.01)),
    Picture("2.10", "regions", EXAMPLE, {"largest_gap": 0.02, "points": 21}),
    Picture("4.1", "trace", EXAMPLE, EARLY),
    Picture("4.2", "phase", EXAMPLE, EARLY),
    Picture("4.3", "poincare", EXAMPLE, MAGNIFIED),
    *list_patterns(6, LOW_DAMPINGS),
    *list_spectra(15, Case(0.025, 0.01)),
    *list_spectra(18, Case(0.05, 0.015)),
    *list_spectra(21, Case(0.075, 0.02)),
    *list_patterns(24, HIGH_DAMPINGS),
    Picture("4.33", "poincare", Case(0.2, 0.015), RECORD),
    Picture("4.34", "poincare", Case(0.25, 0.015), RECORD),
    Picture("4.35", "trace", Case(0.25, 0.015), TRACE),
    Picture("4.36", "poincare", Case(0.25, 0.01), RECORD),
    Picture("4.37", "poincare", Case(0.25, 0.02), RECORD),
    Picture("4.38", "poincare", Case(0.05, 0.02, 0.7), RECORD),
    Picture("4.39", "poincare", Case(0.05, 0.02, 0.5), RECORD),
    Picture("4.40", "profile", Case(0.025, 0.02, 0.7), PATTERN),
    Picture("4.40-text", "profile", Case(TEXT_DAMPING, 0.02, 0.7), PATTERN),
    Picture("4.41", "profile", Case(0.025, 0.02, 0.5), PATTERN),
    Picture("4.41-text", "profile", Case(TEXT_DAMPING, 0.02, 0.5), PATTERN),
    Picture("4.42", "trace", Case(0.05, 0.02), TRACE),
    Picture("4.43", "trace", Case(0.05, 0.02, 0.7), TRACE),
    Picture("4.44", "trace", Case(0.05, 0.02, 0.5), TRACE),
)
# Of all figures the page shows these; F's numbers.
SHOWN = {
    "2.4": "At high speed the wall force changes its sign four times a cycle",
    "2.10": "Where the slider stays on the upper wall for good",
    "4.3": "F's strange attractor, and what the right sign makes of it",
    "4.6": "Transient chaos: spikes on a background; chaos with the right sign",
    "4.25": "Low speed: impacts as published, rest with the right sign",
    "4.44": "e = 0.5: sliding",
}
FIGURES = [
    Drawing[Runs](
        picture.file,
        picture.plot,
        f"Fig. {picture.number}: {SHOWN[picture.number]}" if picture.number in SHOWN else "",
        DPI,
    )
    for picture in PICTURES
]
