"""Designs side by side over speed: a colour for each."""

from collections.abc import Mapping

import matplotlib
import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .speeds import PANELS, RPM, create_panels, has_values, limit_to_contact
from .style import add_title


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
    figure, panels = create_panels(len(shown), below=0.4)
    add_title(figure, "Designs over speed")
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, len(tables)))
    for panel, (title, scale, names) in zip(panels, shown, strict=True):
        for colour, table in zip(colours, tables.values(), strict=True):
            for name in names:
                if name in table:
                    panel.plot(RPM * table["speed"].values, scale * table[name].values, color=colour)
        limit_to_contact(panel, scale, names, tables)
        panel.set_title(title)
    lines = [Line2D([], [], color=c, label=label) for c, label in zip(colours, tables, strict=True)]
    figure.legend(handles=lines, loc="outside lower center", ncols=min(4, len(lines)))
    return figure


def _find_first(tables: Mapping[str, xarray.Dataset], ending: str) -> str:
    """The result of the first part that has it, contacts before others; "" for none."""
    every = list(dict.fromkeys(str(name) for table in tables.values() for name in table.data_vars))
    names = [name for name in every if name.endswith(ending)]
    return min(names, key=lambda name: f"{name.partition('.')[0]}.lost" not in every, default="")
