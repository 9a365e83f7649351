"""A figure of F: its number, its file, its title and how it is drawn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from orchestrator.plots.motion.titles import create_figure

from ..cases import CORRECTED, PUBLISHED, Case
from ..runs import Runs

LABELS = {PUBLISHED: "as published", CORRECTED: "corrected"}
BOTH = "as published and corrected"
INK = "#333c46"
DPI = 110
# What file names do without.
PLAIN = str.maketrans({"é": "e", "ψ": "psi", ",": None})


@dataclass(frozen=True)
class Picture:
    """number: F's, "4.6". title: F's caption without its parameters. case: None where it shows none."""

    number: str
    title: str
    draw: Callable[[Runs, Picture], Figure]
    case: Case | None = None

    @property
    def file(self) -> str:
        chapter, figure = self.number.split(".")
        words = self.title.lower().translate(PLAIN).split()
        name = f"fig-{chapter}.{int(figure):02d}-{'-'.join(words)}"
        if self.case:
            name += f"-lambda-{self.case.damping:.3f}-rho-{self.case.gap:.3f}"
            if self.case.restitution != 0.9:
                name += f"-e-{self.case.restitution:.1f}"
        return f"{name}.png"

    @property
    def shown(self) -> Case:
        """The case of a figure that shows one."""
        assert self.case
        return self.case

    @property
    def heading(self) -> str:
        return f"Fig. {self.number}  {self.title}"

    def head(self, figure: Figure) -> None:
        """The heading of a figure without parameters."""
        figure.suptitle(self.heading, x=0.012, ha="left", fontsize=11, fontweight="bold")

    def frame(
        self, width: float, height: float, mosaic: object, form: str = BOTH, **more: object
    ) -> tuple[Figure, dict[str, Axes]]:
        """Figure and its axes by name; the title has F's number and the parameters."""
        case = self.case
        values: dict[str, object] = {"form": form}
        if case:
            values = {"damping": case.damping, "gap": case.gap, "restitution": case.restitution} | values
        figure, axes = create_figure(self.heading, values, width, height, mosaic=mosaic, **more)
        return figure, axes


def caption(axes: Axes, text: str) -> None:
    """A panel's name above its left end."""
    axes.set_title(text, loc="left", fontsize=9, color=INK)


def note(axes: Axes, text: str, x: float = 0.985, y: float = 0.96) -> None:
    """A remark within a panel."""
    side = "right" if x > 0.5 else "left"
    box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.5}
    axes.text(x, y, text, transform=axes.transAxes, ha=side, va="top", fontsize=7.5, color=INK, bbox=box)
