"""What components do that no other figure draws: a panel for each variable, a colour for each instance.

Elements of an array share a panel.
"""

from itertools import chain

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from . import film_and_load, piston, slider_crank_motion, valve_train
from .data import FigureData
from .style import ACCENT, COUPLED, add_legend_above, create_subplots, label_abscissa

# Panels at most, and lines in each.
PANELS, LINES = 8, 4
COLOURS = (COUPLED, "#e08e0b", ACCENT, "#7b4fa3")
# Times of events that are not known, and the like, are no motion.
ENDLESS = 1e29
# A variable that varies by less than this share of its size is constant.
CONSTANT = 1e-9
# Variables that are an abscissa.
ANGLES = ("cam_angle", "profile_angle", "angle", "crank_angle")


def applies(data: FigureData) -> bool:
    return bool(choose_panels(data))


def choose_panels(data: FigureData) -> dict[str, list[str]]:
    """Outputs to draw, by variable: those with a tolerance and those that drive inputs.

    Where no figure draws anything else, all outputs if there are none of these.
    """
    drawn = set(
        chain.from_iterable(
            kind.list_instances(data) for kind in (valve_train, film_and_load, slider_crank_motion, piston)
        )
    )
    free = [name for name in data.coupled if name.split(".")[0] not in drawn and _varies(data, name)]
    judged = {*data.tolerance, *data.drivers.values()}
    chosen = [name for name in free if name in judged] or ([] if drawn else free)
    found: dict[str, list[str]] = {}
    for name in sorted(chosen, key=lambda name: _rank(data, name)):
        found.setdefault(_split(name)[1], []).append(name)
    return found


def _split(name: str) -> tuple[str, str]:
    """Instance with the index of an element, and variable: shaft[2] and cam_speed of shaft.cam_speed[2]."""
    instance, _, variable = name.partition(".")
    stem, bracket, index = variable.partition("[")
    return instance + bracket + index, stem


def _rank(data: FigureData, name: str) -> tuple[bool, bool]:
    """Outputs with a tolerance come first, and angles last: those of a shaft at constant speed say least."""
    return name not in data.tolerance, data.quantities[name].unit == "rad"


def _varies(data: FigureData, name: str) -> bool:
    """Whether it varies and is not an abscissa."""
    values = data.coupled[name]
    size = float(np.nanmax(np.abs(values), initial=0.0))
    if name.split(".", 1)[1] in ANGLES or size > ENDLESS:
        return False
    return float(np.nanmax(values) - np.nanmin(values)) > CONSTANT * size


def draw(data: FigureData) -> Figure:
    found = choose_panels(data)
    shown = list(found)[:PANELS]
    data = data.of(found[shown[0]][0].split(".")[0])
    which = f", {len(shown)} of {len(found)} variables" if len(found) > len(shown) else ""
    title, size = f"{data.title}: solution{which}", (6.8, 1.3 + 1.8 * len(shown))
    figure, axes = create_subplots(len(shown), 1, title, size, sharex=True, squeeze=False)
    for ax, variable in zip(axes[:, 0], shown, strict=True):
        _draw_panel(ax, data, found[variable], variable)
    label_abscissa(axes[-1, 0], data)
    if data.reference:
        figure.supxlabel(f"Wide pale lines: {data.names[1]}.", fontsize=8.5, x=0.012, ha="left")
    return figure


def _draw_panel(ax: Axes, data: FigureData, names: list[str], variable: str) -> None:
    shown = sorted(names[:LINES], key=list(data.coupled).index)
    for name, colour in zip(shown, COLOURS, strict=False):
        factor, _ = data.shown(name)
        if name in data.reference:
            ax.plot(data.x(True), factor * data.reference[name], color=colour, alpha=0.3, lw=3.4)
        ax.plot(data.x(), factor * data.coupled[name], color=colour, lw=1.1, label=_split(name)[0])
    ax.set_ylabel(data.label(names[0], variable))
    add_legend_above(
        ax, LINES, fontsize=7.0, columnspacing=1.2, handlelength=1.2, alignment="right", title_fontsize=7.0,
        title=f"{LINES} of {len(names)}" if len(names) > LINES else None,
    )  # fmt: skip
