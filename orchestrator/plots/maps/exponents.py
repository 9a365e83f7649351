"""Largest exponent over two parameters: blue stable, red chaotic, grey sliding."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..motion.titles import create_figure, drop_varied
from .labels import LABELS, compute_edges

SLIDING = "#b4bac1"


def draw_exponents(figure: Figure, axes: Axes, data: xarray.Dataset, x: str, y: str) -> None:
    """`data` has largest (y, x), -inf where the motion slides, over x and y."""
    found = data["largest"].values
    finite = found[np.isfinite(found)]
    limit = float(np.abs(finite).max()) if finite.size else 1.0
    axes.set_facecolor(SLIDING)
    axes.grid(False)
    mesh = axes.pcolormesh(
        compute_edges(data["x"].values), compute_edges(data["y"].values), np.ma.masked_invalid(found),
        cmap="RdBu_r", vmin=-limit, vmax=limit, rasterized=True,
    )  # fmt: skip
    bar = figure.colorbar(mesh, ax=axes, pad=0.02)
    bar.set_label("largest Lyapunov exponent (1/rad)")
    bar.outline.set_visible(False)
    axes.set_xlabel(LABELS[x])
    axes.set_ylabel(LABELS[y])
    if finite.size < found.size:
        figure.legend(
            handles=[Patch(color=SLIDING, label="slides (−∞)")],
            loc="upper right",
            bbox_to_anchor=(0.995, 1.0),
        )


def plot_exponent_map(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    figure, axes = create_figure(
        "Largest Lyapunov exponent", drop_varied(values, "x", "y"), width=6.4, height=4.6
    )
    draw_exponents(figure, axes, data, values["x"], values["y"])
    return figure
