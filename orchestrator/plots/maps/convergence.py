"""Lyapunov exponents window by window, their mean so far, and the result with its standard error."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from ..motion.titles import create_figure
from ..style import ACCENT, COUPLED, REFERENCE


def plot_exponents(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has largest_in_window, second_in_window and window_end (window), largest and uncertainty."""
    figure, axes = create_figure("Lyapunov exponents", values, width=6.8, height=3.4)
    end = data["window_end"].values
    slides = np.isneginf(data["largest_in_window"].values)
    axes.axhline(0.0, color="0.4", lw=0.7)
    for name, colour in (("largest", COUPLED), ("second", REFERENCE)):
        local = data[f"{name}_in_window"].values
        axes.plot(
            end, np.where(slides, np.nan, local), ".", ms=3.0, alpha=0.5, color=colour,
            label="" if slides.all() else f"{name}, each window",
        )  # fmt: skip
        if not slides.any():
            mean = np.cumsum(local) / np.arange(1, len(local) + 1)
            axes.plot(end, mean, color=colour, lw=1.3, label=f"{name}, mean so far")
    if slides.any():
        axes.plot(
            end[slides], np.full(slides.sum(), 0.03), ls="", marker="|", ms=5, color=ACCENT,
            transform=axes.get_xaxis_transform(), label="windows in which it slides: −∞",
        )  # fmt: skip
        axes.set_yticks(axes.get_yticks() if not slides.all() else [])
    else:
        largest, error = data["largest"].item(), data["uncertainty"].item()
        axes.axhspan(
            largest - error,
            largest + error,
            color=COUPLED,
            alpha=0.25,
            lw=0.0,
            label="result ± standard error",
        )
    axes.set_xlim(0.0, end[-1])
    axes.set_xlabel("cycles")
    axes.set_ylabel("Lyapunov exponent (1/rad)")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)
    return figure
