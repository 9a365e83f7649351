"""Orbits of journals in their bushes, in parts of the clearance, and the least films below."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from models.core.quantities import Vector

from .data import FigureData
from .style import COUPLED, MUTED, REFERENCE, add_title, create_subplots, label_abscissa, plot_both

# Bearings side by side at most.
COLUMNS = 4


def applies(data: FigureData) -> bool:
    return bool(list_bearings(data))


def list_bearings(data: FigureData) -> list[str]:
    return [name.split(".")[0] for name in data.all("eccentricity_ratio")]


def find_orbit(data: FigureData, bearing: str) -> tuple[Vector, Vector]:
    """The eccentricity over the clearance, along x and y."""
    x, y, ratio = (data.coupled[f"{bearing}.eccentricity{end}"] for end in ("_x", "_y", "_ratio"))
    size = np.hypot(x, y)
    share = np.divide(ratio, size, out=np.zeros_like(ratio), where=size > 0.0)
    return share * x, share * y


def draw(data: FigureData) -> Figure:
    every = list_bearings(data)
    names = sorted(every, key=lambda name: float(np.min(data.coupled[f"{name}.minimum_film_thickness"])))
    names = [name for name in every if name in names[:COLUMNS]]
    which = f", {len(names)} of {len(every)} with the least film" if len(every) > COLUMNS else ""
    figure, axes = create_subplots(
        2, len(names), squeeze=False, figsize=(0.8 + 3.4 * len(names), 5.4), height_ratios=(3, 2)
    )
    add_title(figure, f"{data.title}: journals in their bushes{which}")
    for (above, below), name in zip(axes.T, names, strict=True):
        x, y = find_orbit(data, name)
        above.add_patch(Circle((0.0, 0.0), 1.0, fill=False, color=MUTED))
        above.plot(x, y, color=COUPLED, lw=0.9)
        above.plot(x[:1], y[:1], "o", color=REFERENCE, ms=3.5, label="start")
        above.set(
            aspect="equal", xlim=(-1.08, 1.08), ylim=(-1.08, 1.08), xlabel="Eccentricity over clearance"
        )
        above.set_title(name.replace("_", " "), loc="left")
        plot_both(below, data.of(name), f"{name}.minimum_film_thickness", "Least film")
        below.set_ylim(bottom=0.0)
        label_abscissa(below, data.of(name))
    axes[0, -1].legend(loc="upper right")
    return figure
