"""Regions of sliding in lambda and rho (F 2.10)."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.core.quantities import Vector

from ..style import ACCENT, COUPLED, MUTED, REFERENCE
from .titles import create_figure

INK = "#3a444e"


def draw_regions(axes: Axes, gap: Vector, upper: Vector, lower: Vector, damping: tuple[float, float]) -> None:
    """`upper`, `lower`: lambda from which on the upper wall holds throughout and the lower one nowhere;
    `damping`: the abscissa's limits."""
    low, high = damping
    first, last = np.minimum(upper, lower), np.maximum(upper, lower)
    axes.fill_betweenx(gap, low, first, color=ACCENT, alpha=0.13, lw=0.0)
    axes.fill_betweenx(gap, first, last, where=lower > upper, color=REFERENCE, alpha=0.22, lw=0.0)
    axes.fill_betweenx(gap, first, last, where=lower < upper, color=MUTED, alpha=0.22, lw=0.0)
    axes.fill_betweenx(gap, last, high, color=COUPLED, alpha=0.13, lw=0.0)
    axes.plot(upper, gap, color=COUPLED, lw=1.4)
    axes.plot(lower, gap, color=ACCENT, lw=1.4)
    axes.set_xlim(low, high)
    axes.set_ylim(gap[0], gap[-1])
    axes.set_xlabel("friction λ")
    axes.set_ylabel("clearance ρ")
    middle = 0.6 * gap[-1]
    left, right = np.interp(middle, gap, first), np.interp(middle, gap, last)
    _draw_name(axes, 0.5 * (low + left), middle, "I", "each wall holds\nin a part of the cycle")
    _draw_name(axes, 0.5 * (right + high), middle, "III", "upper wall throughout,\nlower wall nowhere")
    _draw_name_between(axes, gap, upper, lower, high - low)


def _draw_name(axes: Axes, x: float, y: float, name: str, words: str) -> None:
    axes.annotate(name, (x, y), ha="center", va="bottom", fontsize=13, fontweight="bold", color=INK)
    axes.annotate(
        words, (x, y), (0.0, -3.0), textcoords="offset points", ha="center", va="top", fontsize=7.5, color=INK
    )


def _draw_name_between(axes: Axes, gap: Vector, upper: Vector, lower: Vector, span: float) -> None:
    """The name of region II in it, or beside it where it is narrow; that of none of F's where it is in II's
    place."""
    y = 0.85 * gap[-1]
    first, second = np.interp(y, gap, upper), np.interp(y, gap, lower)
    name, words = "II", "upper throughout,\nlower in a part"
    if second < first:
        name, words = "none", "upper in a part,\nlower nowhere"
    middle = 0.5 * (first + second)
    if abs(second - first) > 0.2 * span:
        _draw_name(axes, middle, y, name, words)
        return
    axes.annotate(
        name, (middle, y), (30.0, 0.0), textcoords="offset points", va="center", fontsize=13,
        fontweight="bold", color=INK, arrowprops={"arrowstyle": "-", "color": INK, "lw": 0.8},
    )  # fmt: skip


def plot_regions(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    shown = {name: value for name, value in values.items() if name not in ("damping", "gap")}
    figure, axes = create_figure("Regions of sliding", shown, width=5.6, height=3.8)
    gap, upper, lower = (data[name].values for name in ("gap", "upper", "lower"))
    highest = 1.4 * max(upper.max(), lower.max(), values["damping"])
    draw_regions(axes, gap, upper, lower, damping=(0.0, highest))
    axes.plot(values["damping"], values["gap"], "o", color="#3a444e", ms=4.5)
    axes.annotate(
        "this machine", (values["damping"], values["gap"]), (6, -3), textcoords="offset points", fontsize=7.5
    )
    return figure
