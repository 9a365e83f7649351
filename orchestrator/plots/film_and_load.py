"""Load and film thickness of every contact against the reference, with their errors below."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from .data import FigureData
from .style import ACCENT, both, legend_above, panels


def applies(data: FigureData) -> bool:
    return bool(data.reference) and bool(_names(data))


def _names(data: FigureData) -> list[str]:
    contacts = [name.split(".")[0] for name in data.all("film_thickness")]
    return [f"{contact}.{variable}" for contact in contacts for variable in ("load", "film_thickness")]


def figure(data: FigureData) -> Figure:
    names = _names(data)
    made, axes = panels(2 * len(names), data, f"{data.title}: load and film, with their errors", height=1.45)
    for i, name in enumerate(names):
        contact, variable = name.split(".", 1)
        words = variable.replace("_", " ")
        above, below = axes[2 * i], axes[2 * i + 1]
        both(above, data, name, f"{contact}\n{words}")
        factor, unit = data.shown(name)
        error = factor * (data.coupled[name] - data.reference[name])
        finite = np.abs(error[np.isfinite(error)])
        below.plot(data.x(True), error, color=ACCENT, lw=0.8)
        below.axhline(0.0, color="0.4", lw=0.7)
        top = 1.1 * float(finite.max(initial=0.0)) or 1.0
        below.set_ylim(-top, top)
        below.ticklabel_format(axis="y", style="sci", scilimits=(-2, 3))
        below.set_ylabel(f"error ({unit})")
    legend_above(made, axes[0])
    return made
