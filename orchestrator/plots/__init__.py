"""Figures of a run. To add one: a file with `applies(data)` and `figure(data)`, listed here.

Each file draws one kind of figure from `FigureData` and saves nothing.
"""

from __future__ import annotations

import importlib
from pathlib import Path

from ..results import ResultFile
from ..scenario import Scenario
from .data import FigureData

KINDS = (
    "valve_train",
    "film_and_load",
    "solved_film",
    "difference",
    "slider_crank_motion",
    "slider_crank_phase",
    "piston",
    "steps",
    "energy",
)


def draw(result: ResultFile, folder: Path, title: str, scenario: Scenario) -> list[Path]:
    """Draw every figure that applies into `folder`, as PNG."""
    from .style import saved

    data = FigureData.read(result, title, scenario)
    paths = []
    for name in KINDS:
        kind = importlib.import_module(f".{name}", __package__)
        if kind.applies(data):
            paths.append(saved(lambda kind=kind: kind.figure(data), folder / f"{name}.png"))
    return paths
