"""Designs side by side over speed: a colour for each."""

import math
from collections.abc import Mapping

import matplotlib
import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .speeds import PANELS, RPM, has_values, limit_to_contact
from .style import add_title, create_subplots


def draw_variants(tables: Mapping[str, xarray.Dataset]) -> Figure:
    """The numbers of all cycles over speed, of the first part that has each, scaled by those with contact."""
    shown = []
    for title, scale, endings in PANELS:
        names = [
            name
            for ending in endings
            if (name := _find_first(tables, ending)) and any(has_values(t, name) for t in tables.values())
        ]
        if names:
            shown.append((title, scale, names))
    rows = math.ceil(len(shown) / 3)
    figure, axes = create_subplots(rows, 3, figsize=(11.0, 2.6 * rows + 0.4), squeeze=False, sharex=True)
    add_title(figure, "Designs over speed")
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, len(tables)))
    for panel in axes.flat[len(shown) :]:
        panel.remove()
    for panel, (title, scale, names) in zip(axes.flat, shown, strict=False):
        for colour, table in zip(colours, tables.values(), strict=True):
            for name in names:
                if name in table:
                    panel.plot(RPM * table["speed"].values, scale * table[name].values, color=colour)
        limit_to_contact(panel, scale, names, tables)
        panel.set_title(title)
        panel.ticklabel_format(axis="y", useOffset=False)
    for panel in axes.flat[max(0, len(shown) - 3) : len(shown)]:
        panel.set_xlabel("Speed (r/min)")
        panel.tick_params(labelbottom=True)
    lines = [Line2D([], [], color=c, label=label) for c, label in zip(colours, tables, strict=True)]
    figure.legend(handles=lines, loc="outside lower center", ncols=min(4, len(lines)))
    return figure


def _find_first(tables: Mapping[str, xarray.Dataset], ending: str) -> str:
    """The result of the first part that has it, contacts before others; "" for none."""
    table = next(iter(tables.values()))
    names = [name for name in map(str, table.data_vars) if name.endswith(ending)]
    return min(names, key=lambda name: f"{name.partition('.')[0]}.lost" not in table, default="")
