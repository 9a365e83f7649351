"""Basins of attraction: starts coloured by the attractor on which they end."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from ..motion.titles import create_figure
from .labels import draw_kinds

COLOURS = ("#0b5fa5", "#e9b44c", "#d1495b", "#2a9d5c", "#7b5ea7", "#5aa2d8", "#eb9aa5")
# All rarer attractors together.
REST = "#20242a"


def plot_basins(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has attractor (psi_rate, psi) over the starts, and period, exponent and starts (number)."""
    found = data.sizes["number"]
    title = f"Basins of {found} attractors" if found > 1 else "All starts end on one attractor"
    figure, axes = create_figure(title, values, width=6.8, height=4.6)
    count = min(found, len(COLOURS))
    place = np.minimum(data["attractor"].values, count)
    names = [_format_name(data, n) for n in range(count)]
    colours = list(COLOURS[:count])
    if found > count:
        starts = data["starts"].values
        names.append(f"{found - count} others\n{starts[count:].sum() / starts.sum():.1%}")
        colours.append(REST)
    draw_kinds(figure, axes, 1e3 * data["psi"].values, data["psi_rate"].values, place, colours, names)
    axes.set_xlabel("ψ at crank angle 0 (mrad)")
    axes.set_ylabel("ψ′ at crank angle 0")
    return figure


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
