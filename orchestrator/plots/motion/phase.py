"""psi' over psi (F 4.2)."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.core.quantities import Vector

from ..style import ACCENT, COUPLED, MUTED
from .titles import create_figure
from .trace import MILLI


def draw_phase(
    axes: Axes,
    theta: Vector,
    psi: Vector,
    psi_rate: Vector,
    side: Vector,
    walls: tuple[float, float] | None = None,
) -> None:
    """Arrays as a `Portrait`'s: where theta stands still an impact is, the trajectory is cut and its jump
    drawn lightly. `walls`: psi of the nearest and the farthest that a wall comes to the middle."""
    impacts = np.flatnonzero(np.diff(theta) == 0.0) + 1
    for distance in walls or ():
        for sign in (-1.0, 1.0):
            axes.axvline(sign * MILLI * distance, color=MUTED, lw=0.8, ls=(0, (5, 3)))
    axes.vlines(
        MILLI * psi[impacts], psi_rate[impacts - 1], psi_rate[impacts], color=COUPLED, lw=0.5, alpha=0.25
    )
    psi, psi_rate, side = (np.insert(column, impacts, np.nan) for column in (psi, psi_rate, side))
    axes.plot(MILLI * psi, psi_rate, color=COUPLED, lw=0.9)
    if np.nanmax(np.abs(side)) > 0.0:
        sliding = np.where(np.abs(side) > 0.0, psi_rate, np.nan)
        axes.plot(MILLI * psi, sliding, color=ACCENT, lw=2.2)
    axes.set_xlabel("ψ (mrad)")
    axes.set_ylabel("ψ′")


def plot_phase(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    figure, axes = create_figure("Phase portrait", values, width=5.2, height=4.2)
    theta, psi, rate, side = (data[name].values for name in ("theta", "psi", "psi_rate", "side"))
    wall = data["upper"].values
    draw_phase(axes, theta, psi, rate, side, walls=(float(wall.min()), float(wall.max())))
    return figure
