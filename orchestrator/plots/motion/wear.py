"""Wear along the walls: the energy that impacts take, and how evenly."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, ScalarFormatter

from ..style import ACCENT, COUPLED, MUTED
from .distribution import draw_profile, read_bin_edges
from .titles import add_legend, create_figure

COLOURS = {"upper": COUPLED, "lower": ACCENT}


def plot_wear(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """The profile of energies, and the effective part of each wall that is worn, over the number of bins:
    level for impacts that are spread, falling as one over it for spots (dotted)."""
    mosaic = [["profile", "profile", "share"]]
    figure, axes = create_figure("Wear: energy that impacts take", values, 9.2, 3.4, mosaic=mosaic)
    profile, worn, bins = axes["profile"], axes["share"], data["bins"].values
    draw_profile(profile, read_bin_edges(data), data["upper"].values, -data["lower"].values)
    profile.set_ylabel("energy per cycle / (M l² Ω²)")
    for wall, colour in COLOURS.items():
        if data[f"{wall}_energy"] > 0.0:
            share = data[f"{wall}_worn_share"].values
            worn.plot(bins, share, "o-", ms=3.5, color=colour, label=f"{wall} wall")
            worn.plot(bins, share[0] * bins[0] / bins, ls=":", lw=0.9, color=colour)
    worn.set_xscale("log")
    worn.set_yscale("log")
    worn.set_ylim(top=1.3)
    worn.set_xticks(bins)
    worn.xaxis.set_major_formatter(ScalarFormatter())
    worn.xaxis.set_minor_formatter(NullFormatter())
    worn.yaxis.set_major_formatter(ScalarFormatter())
    worn.annotate("dotted: spots", (0.06, 0.05), xycoords="axes fraction", fontsize=7.5, color=MUTED)
    worn.set_xlabel("bins")
    worn.set_ylabel("worn share of the wall")
    add_legend(figure, profile)
    return figure
