"""Basins of attraction: starts coloured by the attractor on which they end."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from ..motion.titles import create_figure
from .labels import compute_edges

COLOURS = ("#0b5fa5", "#e9b44c", "#d1495b", "#2a9d5c", "#7b5ea7", "#5aa2d8", "#eb9aa5")
# All rarer attractors together.
REST = "#20242a"


def draw_basins(figure: Figure, axes: Axes, data: xarray.Dataset) -> None:
    """`data` has attractor (psi_rate, psi) over the starts, and period, exponent and starts (number)."""
    count = min(data.sizes["number"], len(COLOURS))
    place = np.minimum(data["attractor"].values, count)
    more = data.sizes["number"] > count
    names = [_format_name(data, n) for n in range(count)]
    colours = list(COLOURS[:count])
    if more:
        starts = data["starts"].values
        names.append(f"{data.sizes['number'] - count} others\n{starts[count:].sum() / starts.sum():.1%}")
        colours.append(REST)
    axes.grid(False)
    mesh = axes.pcolormesh(
        compute_edges(1e3 * data["psi"].values), compute_edges(data["psi_rate"].values), place,
        cmap=ListedColormap(colours),
        norm=BoundaryNorm(np.arange(len(colours) + 1) - 0.5, len(colours)), rasterized=True,
    )  # fmt: skip
    bar = figure.colorbar(mesh, ax=axes, pad=0.02, ticks=range(len(colours)))
    bar.ax.set_yticklabels(names)
    bar.ax.tick_params(length=0)
    axes.set_xlabel("ψ at crank angle 0 (mrad)")
    axes.set_ylabel("ψ′ at crank angle 0")


def _format_name(data: xarray.Dataset, n: int) -> str:
    """What an attractor is, and its share of the starts."""
    one = data.isel(number=n)
    period, exponent, error = (one[name].item() for name in ("period", "exponent", "uncertainty"))
    share = one["starts"].item() / data["starts"].values.sum()
    if period:
        words = f"period {period}, slides" if exponent == -math.inf else f"period {period}"
    else:
        words = "chaotic" if exponent > 3.0 * error else "no period found"
    return f"{words}\n{share:.1%}"


def plot_basins(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    found = data.sizes["number"]
    title = f"Basins of {found} attractors" if found > 1 else "All starts end on one attractor"
    figure, axes = create_figure(title, values, width=6.8, height=4.6)
    draw_basins(figure, axes, data)
    return figure
