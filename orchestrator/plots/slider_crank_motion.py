"""Slider-crank with clearance: the piston between its walls, wall forces and impacts."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from .data import FigureData
from .style import ACCENT, COUPLED, MUTED, REFERENCE, add_legend_above, create_panels, plot_both

WALLS = {"upper": COUPLED, "lower": ACCENT}


def applies(data: FigureData) -> bool:
    return bool(data.having("psi") and data.having("piston_offset"))


def list_instances(data: FigureData) -> set[str]:
    """The slider-crank."""
    return set(data.having("psi")) if applies(data) else set()


def draw(data: FigureData) -> Figure:
    instance = data.having("psi")[0]
    data = data.of(instance)
    struck = bool(np.any(data.coupled.get(f"{instance}.impact_count", 0.0)))
    wanted = {
        _draw_offset: True,
        _draw_forces: bool(find_loaded_walls(data, instance)),
        _draw_impacts: struck,
    }
    rows = [row for row, there in wanted.items() if there]
    figure, axes = create_panels(len(rows), data, f"{data.title}: motion between the walls", height=1.9)
    for ax, row in zip(axes, rows, strict=True):
        row(ax, data, instance)
    add_legend_above(axes[0], columns=3)
    return figure


def find_loaded_walls(data: FigureData, instance: str) -> dict[str, str]:
    """The force on each wall that carries any."""
    forces = {side: f"{instance}.{side}_wall_force" for side in WALLS}
    return {side: name for side, name in forces.items() if np.any(data.coupled.get(name, 0.0))}


def _draw_offset(ax: Axes, data: FigureData, instance: str) -> None:
    name = f"{instance}.piston_offset"
    plot_both(ax, data, name, "Piston offset")
    ax.axhline(0.0, color=MUTED, lw=0.7)
    clearance = data.shown(name)[0] * data.parameters.get(f"{instance}.clearance", np.nan)
    for side, words in ((-1.0, "walls"), (1.0, "")):
        ax.axhline(side * clearance, color="0.25", lw=0.9, ls=(0, (5, 3)), label=words)


def _draw_forces(ax: Axes, data: FigureData, instance: str) -> None:
    for side, name in find_loaded_walls(data, instance).items():
        if name in data.reference:
            ax.plot(data.x(True), data.reference[name], color=REFERENCE, alpha=0.5, lw=3.0)
        ax.plot(data.x(), data.coupled[name], color=WALLS[side], lw=1.1, label=f"{side} wall")
    ax.set_ylabel("Wall force (N)")
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]))
    add_legend_above(ax)


def _draw_impacts(ax: Axes, data: FigureData, instance: str) -> None:
    plot_both(ax, data, f"{instance}.impact_count", "Impacts")
    ax.yaxis.set_major_locator(MaxNLocator("auto", integer=True, steps=[1, 2, 5, 10]))
    ax.set_ylim(bottom=0.0)
