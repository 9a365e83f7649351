"""A cam: contour, lift and its derivatives, curvature, pressure angle, entrainment."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from models.core.quantities import Vector

from .style import ACCENT, COUPLED, MUTED, REFERENCE, add_title, create_subplots

MM = 1e3


def draw_cam(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """The contour on the left, curves over the cam angle on the right."""
    figure, axes = create_subplots(3, 3, figsize=(11.0, 7.6), width_ratios=(1.0, 1.0, 1.0))
    name = Path(values["lift_table"]).stem or values["law"]
    add_title(
        figure, f"Cam {name} with follower {values['follower']}, {values['speed'] * 30 / math.pi:.0f} r/min"
    )
    grid = axes[0, 0].get_gridspec()
    for panel in axes[:2, 0]:
        panel.remove()
    _draw_contour(figure.add_subplot(grid[:2, 0]), data, values)
    degrees, speed = np.degrees(data["angle"].values), values["speed"]
    _plot(axes[0, 1], degrees, MM * data["lift"].values, "Lift (mm)")
    if "other_lift" in data:
        axes[0, 1].plot(degrees, MM * data["other_lift"].values, color=REFERENCE, label=values["other"])
        axes[0, 1].legend()
    _plot(axes[1, 1], degrees, speed * data["slope"].values, "Velocity (m/s)")
    _plot(axes[2, 1], degrees, speed**2 * data["curvature"].values, "Acceleration (m/s²)")
    _plot(axes[0, 2], degrees, 1.0 / data["radius_of_curvature"].values, "Curvature of the cam (1/m)")
    _plot(axes[1, 2], degrees, np.degrees(data["pressure_angle"].values), "Pressure angle (°)")
    velocity = speed * data["entraining_velocity"].values
    _plot(axes[2, 2], degrees, velocity, "Entraining velocity (m/s)")
    axes[2, 2].plot(degrees, speed * data["sliding_velocity"].values, color=ACCENT, label="sliding")
    axes[2, 2].legend()
    _plot(axes[2, 0], degrees, speed**3 * data["jerk"].values, "Jerk (m/s³)")
    for panel in (axes[2, 0], axes[2, 1], axes[2, 2]):
        panel.set_xlabel("Cam angle (°)")
    return figure


def _plot(axes: Axes, degrees: Vector, curve: Vector, label: str) -> None:
    axes.axhline(0.0, color=MUTED, lw=0.8)
    axes.plot(degrees, curve, color=COUPLED)
    axes.set_ylabel(label)
    axes.set_xlim(0.0, 360.0)
    axes.xaxis.set_major_locator(MultipleLocator(90.0))


def _draw_contour(axes: Axes, data: xarray.Dataset, values: Mapping[str, Any]) -> None:
    x, y = (MM * data[name].values for name in ("contour_x", "contour_y"))
    axes.fill(x, y, facecolor=COUPLED, alpha=0.15)
    axes.plot(np.append(x, x[0]), np.append(y, y[0]), color=COUPLED)
    turned = np.linspace(0.0, 2.0 * math.pi, 181)
    base = MM * values["base_radius"]
    axes.plot(base * np.cos(turned), base * np.sin(turned), color=MUTED, lw=0.8, ls="--")
    axes.plot(0.0, 0.0, marker="+", color=MUTED, ms=8.0)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_title("Contour (mm), dashed the base circle", loc="left")
