"""The finite line over cam angle: pressures over the line contact's, films at the ends and in the middle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from models.contact.hertz import ELASTIC_LIMIT

from .finite_line import COLORS, MPA, UM
from .style import MUTED, add_title, create_subplots

STYLES = {"aligned": "-", "misaligned": "--"}
# Films are shown down to this share of the largest: at reversals steady ones vanish.
LEAST_SHOWN = 1e-2


def draw_finite_line_cycle(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """Largest pressure, its ratio to the line contact's, films at the ends and in the middle."""
    figure, axes = create_subplots(2, 2, sharex=True, figsize=(10.0, 6.4))
    rpm = values["speed"] * 30.0 / math.pi
    slope = 1e3 * float(np.max(np.abs(data["slope"].values)))
    add_title(
        figure, f"Finite line through the cycle at {rpm:.0f} r/min, quasi-static; up to {slope:.2g} mrad"
    )
    angle = np.degrees(data["angle"].values)
    shown = [name for name in data["aligned"].values if name == "aligned" or values["alignment"] > 0.0]
    for kind in data["kind"].values:
        for name in shown:
            one = data.sel(kind=kind, aligned=name)
            style = {"color": COLORS[str(kind)], "ls": STYLES[str(name)], "label": f"{kind}, {name}"}
            # Dry, the peak at a sharp end is the grid's.
            pressure = np.where(one["smallest_film"].values == 0.0, np.nan, one["largest_pressure"].values)
            axes[0, 0].plot(angle, MPA * pressure, **style)
            axes[0, 1].plot(angle, pressure / data["line_pressure"].values, **style)
            axes[1, 0].plot(angle, _above_zero(one["end_film"].values), **style)
            axes[1, 1].plot(angle, _above_zero(one["middle_film"].values), **style)
    line = {"color": "black", "lw": 0.8, "ls": ":", "label": "line contact"}
    axes[0, 0].plot(angle, MPA * data["line_pressure"].values, **line)
    limit = {"color": "black", "lw": 0.8, "ls": "-.", "label": "elastic limit"}
    axes[0, 0].axhline(MPA * ELASTIC_LIMIT, **limit)
    dry = angle[np.any(data["smallest_film"].values == 0.0, axis=(0, 1))]
    for each in axes.flat:
        for k, reversal in enumerate(dry):
            each.axvline(reversal, color=MUTED, lw=0.8, label="" if k else "reversal: dry, no film")
    for each in axes[1]:
        each.plot(angle, _above_zero(data["line_film"].values), **line)
        each.set_yscale("log")
        each.set_ylim(UM * LEAST_SHOWN * float(np.max(data["line_film"].values)), None)
        each.set_xlabel("cam angle (degrees)")
    axes[1, 0].sharey(axes[1, 1])
    titles = (
        "Largest pressure (MPa)", "Largest pressure over the line contact's",
        "Smallest film at the ends (µm)", "Smallest film in the middle (µm)",
    )  # fmt: skip
    for each, title in zip(axes.flat, titles, strict=True):
        each.set_title(title, loc="left")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 5))
    return figure


def _above_zero(film: np.ndarray[Any, np.dtype[np.float64]]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """In µm, without the zeros of the reversals, which a logarithmic axis cannot show."""
    return UM * np.where(film > 1e-9, film, np.nan)
