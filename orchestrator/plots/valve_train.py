"""Overview of a valve train: load, film, entraining velocity and lift over the cam angle."""

from __future__ import annotations

from matplotlib.figure import Figure

from .data import FigureData
from .style import both, legend_above, panels

ROWS = (
    ("load", "Contact load"),
    ("film_thickness", "Film thickness"),
    ("entraining_velocity", "Entraining velocity"),
    ("position", "Follower lift"),
)


def applies(data: FigureData) -> bool:
    return data.find("entraining_velocity") is not None and data.find("load") is not None


def figure(data: FigureData) -> Figure:
    rows = [(name, words) for variable, words in ROWS if (name := data.find(variable))]
    drawn = "coupled run and reference" if data.reference else "coupled run"
    made, axes = panels(len(rows), data, f"{data.title}: {drawn}")
    for ax, (name, words) in zip(axes, rows, strict=True):
        both(ax, data, name, words)
        if name.endswith("entraining_velocity"):
            ax.axhline(0.0, color="0.4", lw=0.7)
        else:
            ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]))
    legend_above(made, axes[0])
    return made
