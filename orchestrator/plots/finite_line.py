"""A finite line contact: its pressure from above, and what profiles and misalignment do along its length."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .style import ACCENT, COUPLED, MUTED, REFERENCE, add_title, create_subplots

COLORS = {"straight": REFERENCE, "chamfered": MUTED, "crowned": ACCENT, "logarithmic": COUPLED}
MM, MPA, UM = 1e3, 1e-6, 1e6
# Films above this multiple of the smallest show no contact any more.
SHOWN = 6.0
# Pressures above this multiple of the lines' median are one colour.
BRIGHTEST = 2.0


def draw_finite_line(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """Pressure maps of the chosen profile; largest pressure and smallest film along the length of all."""
    names = data["aligned"].values[: 2 if values["alignment"] > 0.0 else 1]
    figure, axes = create_subplots(
        3, len(names), squeeze=False, sharex=True, figsize=(4.6 * len(names) + 1.0, 7.2)
    )
    load, velocity, slope = (data[name].item() for name in ("load", "velocity", "slope"))
    angle = math.degrees(values["angle"])
    add_title(figure, f"Finite line at {angle:.4g}° of cam: {load:.0f} N, {velocity:.2f} m/s")
    for j, name in enumerate(names):
        title = f"{name}, {1e3 * slope:.2g} mrad" if j else str(name)
        _draw_map(figure, axes[0, j], data, j)
        axes[0, j].set_title(f"Pressure (MPa), {values['profile']}, {title}", loc="left")
        _draw_along(axes[1, j], data, "peak_along", j, MPA)
        _draw_along(axes[2, j], data, "least_along", j, UM)
        axes[1, j].axhline(MPA * data["hertz_pressure"].item(), color="black", lw=0.8, ls=":", label="Hertz")
        axes[1, j].set_title("Largest pressure (MPa)", loc="left")
        axes[2, j].set_title("Smallest film (µm)", loc="left")
        lowest = float(np.min(data["least_along"].values[:, j]))
        axes[2, j].set_ylim(0.0, UM * SHOWN * lowest if lowest > 0.0 else None)
        axes[2, j].set_xlabel("y (mm)")
    handles, labels = axes[1, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _draw_map(figure: Figure, axes: Axes, data: xarray.Dataset, alignment: int) -> None:
    x, y, p = data["x"].values, data["y"].values, MPA * data["pressure"].values[alignment]
    loaded = np.flatnonzero(p.max(axis=1) > 0.01 * p.max())
    shown = slice(loaded[0], loaded[-1] + 2)
    # Few cells at an end bear the highest pressures; the colours are for the others.
    mesh = axes.pcolormesh(
        MM * y, UM * x[shown], p[shown], cmap="magma_r", shading="nearest", rasterized=True,
        vmin=0.0, vmax=min(p.max(), BRIGHTEST * float(np.median(p.max(axis=0)))),
    )  # fmt: skip
    axes.set_ylabel("x (µm)")
    axes.grid(False)
    figure.colorbar(mesh, ax=axes, pad=0.01, extend="max")


def _draw_along(axes: Axes, data: xarray.Dataset, name: str, alignment: int, scale: float) -> None:
    for i, kind in enumerate(data["kind"].values):
        line = scale * data[name].values[i, alignment]
        axes.plot(MM * data["y"].values, line, color=COLORS[str(kind)], label=str(kind))
