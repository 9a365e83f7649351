"""Designs side by side over speed: a colour for each, a line style for least, mean and largest values."""

from collections.abc import Mapping

import matplotlib
import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..assessment.lost_contact import find_lost
from .speeds import PANELS, create_panels, has_values, limit_to_contact, plot_over_speed, shade_lost
from .style import MUTED

# Line styles of results that share a panel, by the beginning of their names; others are solid.
STYLES = {"least": "dashed", "mean": "dotted", "largest": "solid"}


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
    lost = any(find_lost(table).any() for table in tables.values())
    title = "Designs over speed" + "; shaded where one loses contact" * lost
    figure, panels = create_panels(len(shown), title, below=0.4)
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, len(tables)))
    used: set[str] = set()
    for panel, (title, scale, names) in zip(panels, shown, strict=True):
        drawn = {name: name.partition(".")[2].partition("_")[0] for name in names} if len(names) > 1 else {}
        used.update(drawn.values())
        for colour, table in zip(colours, tables.values(), strict=True):
            for name in names:
                if name in table:
                    style = STYLES.get(drawn.get(name, ""), "solid")
                    plot_over_speed(panel, table, name, scale, color=colour, ls=style)
            shade_lost(panel, table, None)
        limit_to_contact(panel, scale, names, tables)
        panel.set_title(f"{title}: {names[0].partition('.')[0]}")
    lines = [Line2D([], [], color=c, label=label) for c, label in zip(colours, tables, strict=True)]
    lines += [
        Line2D([], [], color=MUTED, ls=style, label=word) for word, style in STYLES.items() if word in used
    ]
    figure.legend(handles=lines, loc="outside lower center", ncols=min(4, len(lines)))
    return figure


def _find_first(tables: Mapping[str, xarray.Dataset], ending: str) -> str:
    """The result of the first part that has it, contacts before others; "" for none."""
    every = list(dict.fromkeys(str(name) for table in tables.values() for name in table.data_vars))
    names = [name for name in every if name.endswith(ending)]
    return min(names, key=lambda name: f"{name.partition('.')[0]}.lost" not in every, default="")
