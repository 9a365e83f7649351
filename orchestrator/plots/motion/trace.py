"""psi over crank angle, between its walls (F 4.1)."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.core.quantities import Vector

from ..style import ACCENT, COUPLED, MUTED
from .angles import set_angle_axis, shift_to_first_turn
from .titles import add_legend, create_figure

MILLI = 1e3


def draw_trace(axes: Axes, theta: Vector, psi: Vector, side: Vector, upper: Vector, lower: Vector) -> None:
    """Arrays as a `Portrait`'s; walls dashed, sliding in another colour."""
    angle = shift_to_first_turn(theta)
    draw_walls(axes, angle, upper, lower)
    axes.plot(angle, MILLI * psi, color=COUPLED, lw=1.0, label="flight")
    if np.any(side != 0.0):
        sliding = np.where(side != 0.0, MILLI * psi, np.nan)
        axes.plot(angle, sliding, color=ACCENT, lw=2.4, solid_capstyle="butt", label="sliding")
    set_angle_axis(axes, angle[0], 2.0 * np.pi * np.ceil(angle[-1] / (2.0 * np.pi)))
    axes.margins(y=0.08)
    axes.set_ylabel("ψ (mrad)")


def draw_walls(axes: Axes, angle: Vector, upper: Vector, lower: Vector) -> None:
    """Both walls in psi over crank angle."""
    for n, wall in enumerate((upper, lower)):
        axes.plot(angle, MILLI * wall, color=MUTED, lw=0.9, ls=(0, (5, 3)), label="walls" if n == 0 else None)


def plot_trace(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    figure, axes = create_figure("Time trace", values, width=6.8, height=3.0)
    theta, psi, side, upper, lower = (
        data[name].values for name in ("theta", "psi", "side", "upper", "lower")
    )
    draw_trace(axes, theta, psi, side, upper, lower)
    add_legend(figure, axes)
    return figure
