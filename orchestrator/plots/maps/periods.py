"""Period over two parameters, a colour for each short one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from ..motion.titles import create_figure, drop_varied
from .labels import LABELS, compute_edges

# None, 1 to 8, 9 to 16, 17 to 100, longer. Periods n and 2n have shades of one colour.
BOUNDS = (-0.5, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.5, 16.5, 100.5, np.inf)
COLOURS = (
    "#20242a", "#0b5fa5", "#5aa2d8", "#d1495b", "#a8d0ee", "#2a9d5c", "#eb9aa5", "#7b5ea7", "#dcedf9",
    "#e9b44c", "#f3d9a0", "#f7f3ea",
)  # fmt: skip
NAMES = ("none", "1", "2", "3", "4", "5", "6", "7", "8", "9–16", "17–100", "> 100")


def draw_periods(figure: Figure, axes: Axes, data: xarray.Dataset, x: str, y: str, cycles: int) -> None:
    """`data` has period (y, x), 0 where none was found within so many cycles, over x and y."""
    colours = ListedColormap(COLOURS)
    place = np.searchsorted(BOUNDS[1:-1], data["period"].values)
    axes.grid(False)
    mesh = axes.pcolormesh(
        compute_edges(data["x"].values), compute_edges(data["y"].values), place, cmap=colours,
        norm=BoundaryNorm(np.arange(len(NAMES) + 1) - 0.5, len(NAMES)), rasterized=True,
    )  # fmt: skip
    bar = figure.colorbar(mesh, ax=axes, pad=0.02, ticks=range(len(NAMES)))
    bar.ax.set_yticklabels(NAMES)
    bar.ax.tick_params(length=0)
    bar.set_label(f"period (cycles; none: not within {cycles})")
    axes.set_xlabel(LABELS[x])
    axes.set_ylabel(LABELS[y])


def plot_period_map(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    figure, axes = create_figure("Period", drop_varied(values, "x", "y"), width=6.4, height=4.6)
    draw_periods(figure, axes, data, values["x"], values["y"], values["cycles"])
    return figure
