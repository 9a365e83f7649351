"""Impact distribution profile (F 4.6 to 4.14) and impact spectrum (F 4.16, 4.17)."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import FuncFormatter, MaxNLocator

from models.core.quantities import Vector

from ..style import ACCENT, COUPLED, MUTED
from .angles import format_angle
from .titles import add_legend, create_figure


def read_bin_edges(data: xarray.Dataset) -> Vector:
    """Edges of the bins of a table."""
    edges: Vector = np.append(data["start"].values, data["end"].values[-1])
    return edges


def draw_profile(axes: Axes, edges: Vector, upper: Vector, lower: Vector) -> None:
    """Bars along the wall: the upper wall's values upwards, the lower one's (negative) downwards."""
    for values, colour, words in ((upper, COUPLED, "upper wall"), (lower, ACCENT, "lower wall")):
        axes.stairs(values, edges, fill=True, color=colour, alpha=0.85, lw=0.0, label=words)
    axes.axhline(0.0, color=MUTED, lw=0.8)
    axes.set_xlim(edges[0], edges[-1])
    axes.yaxis.set_major_locator(MaxNLocator(6, symmetric=True))
    axes.set_xlabel("place on the wall x / l  (left: θ = π, right: θ = 0)")


def draw_spectrum(axes: PolarAxes, edges: Vector, values: Vector, colour: str = COUPLED) -> None:
    """Bars around the revolution, as long as the values are large; the scale stands on the emptier side."""
    axes.bar(
        edges[:-1],
        np.abs(values),
        width=np.diff(edges),
        align="edge",
        color=colour,
        alpha=0.85,
        linewidth=0.0,
    )
    axes.set_xticks(0.25 * math.pi * np.arange(8))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda angle, _: _format_eighth(angle)))
    if np.any(values):
        axes.yaxis.set_major_locator(MaxNLocator(4))
    else:
        axes.set_yticks([])
    axes.tick_params(axis="y", labelsize=7.0, labelcolor="#55606b")
    middles = 0.5 * (edges[:-1] + edges[1:])
    heavy = float(np.angle(np.sum(np.abs(values) * np.exp(1j * middles))))
    axes.set_rlabel_position(math.degrees(heavy) + 180.0)
    axes.spines["polar"].set_color(MUTED)


def _format_eighth(angle: float) -> str:
    quarters = round(4.0 * angle / math.pi)
    return format_angle(angle) if quarters % 2 == 0 else f"{'' if quarters == 1 else quarters}π/4"


def plot_profile(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    figure, axes = create_figure("Impact distribution profile", values, width=6.8, height=3.2)
    draw_profile(axes, read_bin_edges(data), data["upper"].values, data["lower"].values)
    axes.set_ylabel(f"⟨{'ψ′' if values['velocity'] == 'psi_rate' else 'approach'}⟩ per {values['per']}")
    add_legend(figure, axes)
    return figure


def plot_spectrum(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    polar = {"projection": "polar"}
    figure, axes = create_figure(
        "Impact spectra", values, 7.2, 3.7, mosaic=[["upper", "lower"]], subplot_kw=polar
    )
    for wall, colour in (("upper", COUPLED), ("lower", ACCENT)):
        draw_spectrum(axes[wall], read_bin_edges(data), data[wall].values, colour)
        none = "" if data[wall].values.any() else ": no impacts"
        axes[wall].set_title(f"{wall} wall{none}", fontsize=9)
    return figure
