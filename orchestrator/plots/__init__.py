"""Figures of a run. To add one, write a file with `applies(data)` and `draw(data)` and list it here.

Each file draws one kind of figure from `FigureData` and saves nothing.
"""

import importlib
from functools import partial
from pathlib import Path

from .data import FigureData

KINDS = (
    "valve_train", "valves", "clearance", "film_and_load", "solved_film", "journal_orbits", "difference",
    "slider_crank_motion", "slider_crank_phase", "piston", "solution", "steps", "energy",
)  # fmt: skip


def draw_figure(name: str, data: FigureData, folder: Path) -> None:
    """Draw a figure of `KINDS` into `folder`, as PNG, if it applies."""
    from .style import save_figure  # matplotlib takes long to import

    kind = importlib.import_module(f".{name}", __package__)
    if kind.applies(data):
        save_figure(partial(kind.draw, data), folder / f"{name}.png")
