"""Constraint forces over crank angle (F 2.4 to 2.9)."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.core.quantities import Vector

from ..style import ACCENT, COUPLED, MUTED
from .angles import set_angle_axis
from .titles import add_legend, create_figure


def draw_force(
    axes: Axes,
    theta: Vector,
    upper: Vector,
    lower: Vector,
    window: tuple[float, float] = (0.0, 2.0 * math.pi),
    label: bool = True,
) -> None:
    """f_u and f_l, filled where the wall can hold the slider; `window`: crank angles."""
    inside = (theta >= window[0]) & (theta <= window[1])
    angle = theta[inside]
    axes.axhline(0.0, color=MUTED, lw=0.8)
    for force, colour, words in ((upper, COUPLED, "upper wall"), (lower, ACCENT, "lower wall")):
        shown = force[inside]
        axes.fill_between(angle, 0.0, np.maximum(shown, 0.0), color=colour, alpha=0.15, lw=0.0)
        axes.plot(angle, shown, color=colour, lw=1.3, label=words)
    set_angle_axis(axes, *window)
    if label:
        axes.set_ylabel("force f / (M l Ω²)")


def plot_force(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    figure, axes = create_figure("Constraint forces", values, width=6.8, height=3.0)
    theta, upper, lower = (data[name].values for name in ("theta", "upper", "lower"))
    draw_force(axes, theta, upper, lower, window=(values["start"], values["end"]))
    add_legend(figure, axes)
    return figure
