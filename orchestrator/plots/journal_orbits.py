"""Orbits of journals in their bushes, in parts of the clearance, also magnified; the least films below.

The bush has its oil grooves, and the direction of the largest load on it.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.core.quantities import Vector

from .data import FigureData
from .style import (
    ACCENT,
    COUPLED,
    MUTED,
    REFERENCE,
    create_subplots,
    label_abscissa,
    list_handles,
    plot_both,
    write_remark,
)

# Bearings side by side at most.
COLUMNS = 4
# Of the magnified orbit, so that one that rests is a point.
LEAST_REACH = 1e-3


def applies(data: FigureData) -> bool:
    return bool(list_bearings(data))


def list_bearings(data: FigureData) -> list[str]:
    """Those that show where their journal is."""
    return [part for part in data.having("eccentricity_ratio") if f"{part}.eccentricity_x" in data.coupled]


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
    title = f"{data.title}: journals in their bushes{which}"
    size = (0.4 + 3.6 * len(names), 10.6)
    figure, axes = create_subplots(3, len(names), title, size, squeeze=False, height_ratios=(3, 3, 2))
    for (above, magnified, below), name in zip(axes.T, names, strict=True):
        orbit = find_orbit(data, name)
        _draw_orbit(above, orbit, (0.0, 0.0), 1.08)
        above.set_title(name.replace("_", " "), loc="left")
        _draw_arc(above, 0.0, 360.0, color=MUTED, lw=1.0, label="bush")
        _draw_grooves(above, data, name)
        _draw_load(above, data, name)
        middle = [0.5 * float(np.min(part) + np.max(part)) for part in orbit]
        reach = 0.6 * max(float(np.ptp(part)) for part in orbit)
        _draw_orbit(magnified, orbit, middle, max(reach, LEAST_REACH))
        magnified.set_title("enlarged", loc="left", fontsize=9.0)
        plot_both(below, data.of(name), f"{name}.minimum_film_thickness", "Least film")
        below.set_ylim(bottom=0.0)
        below.set_box_aspect(2 / 3)  # as wide as the squares of the orbits
        below.set_anchor("W")
        label_abscissa(below, data.of(name))
    found = list_handles([axes[2, 0], axes[0, 0]])
    columns = min(len(found), 3 * len(names))
    figure.legend(found.values(), found.keys(), loc="outside lower center", ncols=columns)
    return figure


def _draw_orbit(axes: Axes, orbit: tuple[Vector, Vector], middle: Sequence[float], reach: float) -> None:
    """The part of it that is at most `reach` from the middle, along x and y."""
    x, y = orbit
    axes.plot(x, y, color=COUPLED, lw=0.9)
    axes.plot(x[:1], y[:1], "o", color=ACCENT, ms=3.5, label="start")
    axes.set(aspect="equal", xlabel="Eccentricity over clearance, x", ylabel="Eccentricity over clearance, y")
    axes.set_anchor("W")
    axes.set_xlim(middle[0] - reach, middle[0] + reach)
    axes.set_ylim(middle[1] - reach, middle[1] + reach)


def _draw_grooves(axes: Axes, data: FigureData, bearing: str) -> None:
    """Two opposite arcs of the bush where its film has axial grooves."""
    assert data.system
    model = data.system.instances[bearing].component.parameters.field("film_model").quantity.choices
    if model[int(data.parameters[f"{bearing}.film_model"])] != "grooved":
        return
    middle, width = (np.degrees(data.parameters[f"{bearing}.groove_{name}"]) for name in ("angle", "width"))
    for begin in (middle - 0.5 * width, middle + 180.0 - 0.5 * width):
        _draw_arc(axes, begin, begin + width, color=ACCENT, lw=5.0, solid_capstyle="butt", label="groove")


def _draw_arc(axes: Axes, begin: float, end: float, **style: Any) -> None:
    """Of the bush, between two angles (deg)."""
    angle = np.radians(np.linspace(begin, end, 181))
    axes.plot(np.cos(angle), np.sin(angle), **style)


def _draw_load(axes: Axes, data: FigureData, bearing: str) -> None:
    """From the middle towards the bush; the forces are those on the journal."""
    load = data.coupled[f"{bearing}.load"]
    row = int(np.argmax(load))
    if load[row] > 0.0:
        x, y = (-float(data.coupled[f"{bearing}.force_{axis}"][row]) for axis in "xy")
        ends = ([0.0, x / np.hypot(x, y)], [0.0, y / np.hypot(x, y)])
        axes.plot(*ends, color=REFERENCE, lw=1.2, ls="--", marker=".", markevery=[1], label="largest load")
        write_remark(axes, f"largest load {load[row]:.3g} N")
