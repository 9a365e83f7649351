"""States at crank angle zero and finite-time exponents over cycles: what a classification rests on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from ..motion.titles import create_figure
from ..style import ACCENT, COUPLED, MUTED, REFERENCE


def plot_classification(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """Two axes over the same cycles; `data` has psi (cycle), finite_time_exponent (window), the results."""
    title = f"Classification: {data['kind'].item()}"
    figure, axes = create_figure(title, values, width=6.8, height=4.4, mosaic="A;B", sharex=True)
    states, exponents = axes["A"], axes["B"]
    cycle = data["cycle"].values
    size = min(4.0, max(0.5, 4e3 / len(cycle)))
    states.scatter(cycle, 1e3 * data["psi"].values, s=size, color=COUPLED, lw=0, rasterized=True)
    states.set_ylabel("ψ at crank angle 0 (mrad)")
    states.margins(x=0.01)
    local = data["finite_time_exponent"].values
    slides = np.isneginf(local)
    end = data["window_end"].values
    exponents.axhline(0.0, color=MUTED, lw=0.8)
    exponents.plot(end, np.where(slides, np.nan, local), color=COUPLED, lw=0.9, marker=".", ms=2.5)
    if slides.any():
        exponents.plot(
            end[slides], np.full(slides.sum(), 0.03), ls="", marker="|", ms=5, color=ACCENT,
            transform=exponents.get_xaxis_transform(), label="slides",
        )  # fmt: skip
    if data["period"].item() and cycle[0] < data["transient"].item() < cycle[-1]:
        for panel in (states, exponents):
            panel.axvline(data["transient"].item(), color=REFERENCE, lw=1.0, ls=(0, (5, 3)))
        exponents.plot([], [], color=REFERENCE, lw=1.0, ls=(0, (5, 3)), label="settled")
    if exponents.get_legend_handles_labels()[0]:
        exponents.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
    exponents.set_ylabel("finite-time\nexponent (1/rad)")
    exponents.set_xlabel("cycle")
    return figure
