"""Slider-crank with clearance: psi between its walls, wall force and impacts."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .data import FigureData
from .style import ACCENT, COUPLED, MUTED, REFERENCE, both, legend_above, panels


def applies(data: FigureData) -> bool:
    return data.find("piston_offset") is not None and data.find("psi") is not None


def figure(data: FigureData) -> Figure:
    offset = str(data.find("piston_offset"))
    instance = offset.split(".")[0]
    rows = 4 if f"{instance}.impact_count" in data.coupled else 3
    made, axes = panels(rows, data, f"{data.title}: motion between the walls")
    both(axes[0], data, offset, "Piston offset")
    # Contact is kept to the walls, so the largest excursion on each side shows where they are.
    both(axes[1], data, f"{instance}.psi", "Deviation ψ")
    _forces(axes[2], data, instance)
    if rows == 4:
        both(axes[3], data, f"{instance}.impact_count", "Impacts")
    for ax in axes[:2]:
        ax.axhline(0.0, color=MUTED, lw=0.7)
    legend_above(made, axes[0])
    return made


def _forces(ax: Axes, data: FigureData, instance: str) -> None:
    for variable, colour, words in (
        ("upper_wall_force", COUPLED, "upper wall"),
        ("lower_wall_force", ACCENT, "lower wall"),
    ):
        name = f"{instance}.{variable}"
        if name in data.reference:
            ax.plot(data.x(True), data.reference[name], color=REFERENCE, alpha=0.5, lw=3.0)
        ax.plot(data.x(), data.coupled[name], color=colour, lw=1.1, label=words)
    ax.set_ylabel("Wall force (N)")
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
