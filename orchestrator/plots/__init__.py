"""Figures of a run. To add one, write a file with `applies(data)` and `draw(data)` and list it here.

Each file draws one kind of figure from `FigureData` and saves nothing.
"""

import importlib
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from models.core.system import System

from ..errors import Command, RunError
from ..store.result_file import ResultFile
from .data import FigureData

KINDS = (
    "valve_train", "valves", "clearance", "film_and_load", "solved_film", "journal_orbits", "difference",
    "slider_crank_motion", "slider_crank_phase", "piston", "solution", "steps", "energy",
)  # fmt: skip


def find_figures(
    result: ResultFile, title: str, system: System, tolerance: Mapping[str, float], over: str | None = None
) -> dict[str, Callable[[], Any]]:
    """The functions that draw the figures that apply, by name; over that angle, if the system has it."""
    data = FigureData.read(result, title, system, tolerance).over(over)
    kinds = {name: importlib.import_module(f".{name}", __package__) for name in KINDS}
    return {name: partial(kind.draw, data) for name, kind in kinds.items() if kind.applies(data)}


def draw_all(figures: Mapping[str, Callable[[], Any]], folder: Path) -> list[Path]:
    """Draw what `find_figures` gives into `folder`, as PNG. RunError names a figure that fails."""
    from .style import save_figure

    paths = []
    for name, figure in figures.items():
        try:
            paths.append(save_figure(figure, folder / f"{name}.png"))
        except (OSError, MemoryError):
            raise
        except Exception as error:
            raise RunError(
                f"figure {name}: unexpected {type(error).__name__}: {error}",
                ("once it is mended, ", Command("resume"), " draws the figures of this run"),
            ) from error
    return paths
