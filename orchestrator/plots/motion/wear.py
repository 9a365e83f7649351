"""Wear along the walls: the energy that impacts take, and how evenly."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, ScalarFormatter

from models.core.quantities import Vector

from ..style import ACCENT, COUPLED, MUTED
from .distribution import draw_profile, read_bin_edges
from .titles import add_legend, create_figure

COLOURS = {"upper": COUPLED, "lower": ACCENT}


def draw_worn_share(axes: Axes, bins: Vector, shares: Mapping[str, Vector], label: bool = True) -> None:
    """Effective part of each wall that is worn, over the number of bins: level for impacts that are spread,
    falling as one over it for spots (dotted)."""
    for wall, share in shares.items():
        axes.plot(bins, share, "o-", ms=3.5, color=COLOURS[wall], label=f"{wall} wall")
        axes.plot(bins, share[0] * bins[0] / bins, ls=":", lw=0.9, color=COLOURS[wall])
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(top=1.3)
    axes.set_xticks(bins)
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_major_formatter(ScalarFormatter())
    if label:
        axes.annotate("dotted: spots", (0.06, 0.05), xycoords="axes fraction", fontsize=7.5, color=MUTED)
        axes.set_xlabel("bins")
        axes.set_ylabel("worn share of the wall")


def plot_wear(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    mosaic = [["profile", "profile", "share"]]
    figure, axes = create_figure("Wear: energy that impacts take", values, 9.2, 3.4, mosaic=mosaic)
    draw_profile(axes["profile"], read_bin_edges(data), data["upper"].values, -data["lower"].values)
    axes["profile"].set_ylabel("energy per cycle / (M l² Ω²)")
    shares = {wall: data[f"{wall}_worn_share"].values for wall in COLOURS if data[f"{wall}_energy"] > 0.0}
    draw_worn_share(axes["share"], data["bins"].values, shares)
    add_legend(figure, axes["profile"])
    return figure
