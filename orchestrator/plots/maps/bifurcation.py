"""Bifurcation diagram; the points are drawn as pixels, so that any number of them makes a small file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MultipleLocator

from ..motion.angles import format_angle
from ..motion.titles import add_legend, create_figure, drop_varied
from ..style import COUPLED, REFERENCE
from .labels import LABELS

RECORDED = {
    "impact_rate": "ψ′ before upper-wall impacts",
    "impact_angle": "crank angle of upper-wall impacts θ (rad)",
    "strobe_psi": "ψ at crank angle 0 (mrad)",
}
# Direction, its colour and its name; the later one lies above.
DIRECTIONS = ((-1, REFERENCE, "downwards"), (1, COUPLED, "upwards"), (0, COUPLED, None))


def plot_bifurcation(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has value, recorded and direction of every point."""
    figure, axes = create_figure("Bifurcation diagram", drop_varied(values, "x"), width=6.8, height=4.2)
    record = values["record"]
    value, direction = data["value"].values, data["direction"].values
    recorded = data["recorded"].values * (1e3 if record == "strobe_psi" else 1.0)
    # The places' distance in points of the page, and a little less; where points coincide they add up.
    size = min(2.0, max(0.4, 300.0 / len(np.unique(value)))) ** 2 if len(value) else 1.0
    for which, colour, name in DIRECTIONS:
        chosen = direction == which
        if chosen.any():
            axes.scatter(
                value[chosen], recorded[chosen], s=size, color=colour, lw=0, alpha=0.2, rasterized=True
            )
            axes.plot([], [], ls="", marker="o", ms=4, color=colour, label=name)
    axes.margins(x=0.01)
    axes.set_xlabel(LABELS[values["x"]])
    axes.set_ylabel(RECORDED[record])
    if record == "impact_angle":
        axes.set_ylim(0.0, 2.0 * np.pi)
        axes.yaxis.set_major_locator(MultipleLocator(np.pi / 2.0))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda angle, _: format_angle(angle)))
    add_legend(figure, axes)
    return figure
