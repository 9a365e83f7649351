"""Period over two parameters, a colour for each short one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from ..motion.titles import create_figure, drop_varied
from .labels import LABELS, draw_kinds

# None, 1 to 8, 9 to 16, 17 to 100, longer. Periods n and 2n have shades of one colour.
BOUNDS = (-0.5, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.5, 16.5, 100.5, np.inf)
COLOURS = (
    "#20242a", "#0b5fa5", "#5aa2d8", "#d1495b", "#a8d0ee", "#2a9d5c", "#eb9aa5", "#7b5ea7", "#dcedf9",
    "#e9b44c", "#f3d9a0", "#f7f3ea",
)  # fmt: skip
NAMES = ("none", "1", "2", "3", "4", "5", "6", "7", "8", "9–16", "17–100", "> 100")


def plot_period_map(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has period (y, x), 0 where none was found, over x and y."""
    figure, axes = create_figure("Period", drop_varied(values, "x", "y"), width=6.4, height=4.6)
    place = np.searchsorted(BOUNDS[1:-1], data["period"].values)
    bar = draw_kinds(figure, axes, data["x"].values, data["y"].values, place, COLOURS, NAMES)
    bar.set_label(f"period (cycles; none: not within {values['cycles']})")
    axes.set_xlabel(LABELS[values["x"]])
    axes.set_ylabel(LABELS[values["y"]])
    return figure
