"""All valve trains of an engine: contact load and lift of each over the angle of their common drive."""

from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from ..assessment.trains import find_drive_angle
from .data import FigureData
from .style import MUTED, create_grid, label_abscissa, plot_both, shade

COLUMNS = 4


def applies(data: FigureData) -> bool:
    return len(data.trains) > 1


def draw(data: FigureData) -> Figure:
    lifts = {train.contacts[0]: train.lift for train in data.trains}
    names = [name for name in data.list_instances() if name in lifts]
    data = replace(data, angle=find_drive_angle(data.system)) if data.system else data
    lost = any(data.lost(name).any() for name in names)
    title = (
        f"{data.title}: contact loads of {len(names)} valve trains{', shaded where contact is lost' * lost}"
    )
    columns = min(COLUMNS, len(names))
    figure, panels = create_grid(len(names), columns, title, (12.0, 1.9), 1.1, sharex=True, sharey=True)
    x, top = data.x(), 1.05 * max(float(np.max(data.coupled[f"{name}.load"])) for name in names)
    for ax, name in zip(panels, names, strict=True):
        lift = data.coupled.get(lifts[name], np.zeros_like(x))
        share = lift / (float(np.max(lift)) or 1.0)
        ax.fill_between(
            x, 0.0, 0.35 * top * share, color=MUTED, alpha=0.35, lw=0.0, label="lift (not to scale)"
        )
        plot_both(ax, data, f"{name}.load", "Load")
        shade(ax, data, name)
        ax.set_title(name, loc="left", fontsize=8.5)
    panels[0].set_ylim(0.0, top)
    for ax in set(panels) - set(panels[::columns]):
        ax.set_ylabel("")
    for ax in panels[-columns:]:
        label_abscissa(ax, data)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=len(labels))
    return figure
