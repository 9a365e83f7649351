"""Error of every compared variable, relative to the reference's range, on a logarithmic scale."""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from models.quantities import Vector

from .data import FigureData
from .style import headed, over_time, subplots

# Rounding errors, relative to the range; what is below is not shown.
FLOOR = 1e-15
VARIABLES = (
    "load", "film_thickness", "minimum_film_thickness", "position", "velocity", "drive_torque", "psi",
    "crank_torque",
)  # fmt: skip


def applies(data: FigureData) -> bool:
    return bool(_names(data))


def _names(data: FigureData) -> list[str]:
    names = [
        name
        for name in data.reference
        if name.split(".", 1)[1] in VARIABLES and np.ptp(data.reference[name]) > 0.0
    ]
    return names[:8]


def figure(data: FigureData) -> Figure:
    names = _names(data)
    made, ax = subplots(figsize=(6.8, 4.2))
    headed(made, f"{data.title}: error of the coupled run")
    # Every second one dashed: errors that are alike, as those of two films of one formula, are both seen.
    colours = colormaps["tab10"].colors[: len(names)]
    x, hidden = data.x(True), False
    for i, (name, colour) in enumerate(zip(names, colours, strict=True)):
        relative = data.difference(name) / np.ptp(data.reference[name])
        first, top = envelope(np.where(relative > FLOOR, relative, np.nan))
        hidden |= bool(np.isnan(top).any())
        ax.semilogy(x[first], top, "--" if i % 2 else "-", color=colour, lw=1.2, label=name)
    over_time(ax, data)
    if hidden:
        ax.set_title(f"errors below {FLOOR:.0e} are not drawn", loc="right", fontsize=8.5)
    ax.set_ylabel("|coupled − reference| / range of the reference")
    made.legend(loc="outside lower center", ncols=min(3, len(names)), handlelength=1.6)
    return made


def envelope(values: Vector, bins: int = 400) -> tuple[Vector, Vector]:
    """The largest value of each bin, and its first place: dips at changes of sign would hide the line."""
    if len(values) <= 2 * bins:
        return np.arange(len(values)), values
    first = np.arange(bins) * len(values) // bins
    return first, np.fmax.reduceat(values, first)
