"""Largest exponent over two parameters: blue stable, red chaotic, grey sliding."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..motion.titles import create_figure, drop_varied
from .labels import LABELS, draw_cells

SLIDING = "#b4bac1"


def plot_exponent_map(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has largest (y, x), -inf where the motion slides, over x and y."""
    title, shown = "Largest Lyapunov exponent", drop_varied(values, "x", "y")
    figure, axes = create_figure(title, shown, width=6.4, height=4.6)
    found = data["largest"].values
    finite = found[np.isfinite(found)]
    limit = float(np.abs(finite).max()) if finite.size else 1.0
    axes.set_facecolor(SLIDING)
    bar = draw_cells(
        figure, axes, data["x"].values, data["y"].values, np.ma.masked_invalid(found),
        cmap="RdBu_r", vmin=-limit, vmax=limit,
    )  # fmt: skip
    bar.set_label("largest Lyapunov exponent (1/rad)")
    bar.outline.set_visible(False)
    axes.set_xlabel(LABELS[values["x"]])
    axes.set_ylabel(LABELS[values["y"]])
    if finite.size < found.size:
        figure.legend(
            handles=[Patch(color=SLIDING, label="slides (−∞)")],
            loc="upper right",
            bbox_to_anchor=(0.995, 1.0),
        )
    return figure
