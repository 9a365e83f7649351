"""Contacts whose film is solved for: load, film, highest pressure, film ratio and, of a heated film,
temperatures, a column for each.

Over the angle of the shaft that drives it; shaded where the contact is lost.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, LogLocator, MaxNLocator, NullFormatter

from .data import FigureData
from .style import ACCENT, COUPLED, MUTED, add_legend_above, create_subplots, label_abscissa, plot_both, shade

ROWS = (
    ("load", "Load"),
    ("minimum_film_thickness", "Film thickness"),
    ("maximum_pressure", "Highest pressure"),
    ("film_ratio", "Film ratio"),
)
# Rows of heated films.
HOT, SURFACE = "film_temperature", "surface_temperature"
FREEZING = 273.15
# Ratios of film and composite roughness; above the second hardly any asperities touch.
EQUAL, FULL = 1.0, 3.0
# Above the highest load, in ranges; beside the levels of the film ratio, as a factor.
HEADROOM, ROOM = 0.05, 1.7


def applies(data: FigureData) -> bool:
    return bool(find_solved_contacts(data))


def find_solved_contacts(data: FigureData) -> list[str]:
    """Contacts whose film is solved for."""
    return [name for name in data.having("film_ratio") if f"{name}.field_tolerance" in data.parameters]


def draw(data: FigureData) -> Figure:
    names = find_solved_contacts(data)
    width = 6.8 if len(names) == 1 else 0.8 + 4.6 * len(names)
    heated = [name for name in names if f"{name}.{HOT}" in data.coupled]
    rows = (*ROWS, (HOT, "Temperature")) if heated else ROWS
    size = (width, 1.9 * len(rows))
    title = f"{data.title}: the solved film"
    figure, axes = create_subplots(len(rows), len(names), title, size, sharex="col", squeeze=False)
    for column, name in zip(axes.T, names, strict=True):
        own = data.of(name)
        for ax, (variable, words) in zip(column, rows, strict=True):
            if variable == HOT and name not in heated:
                ax.set_visible(False)
                continue
            plot_both(ax, own, f"{name}.{variable}", words)
            shade(ax, own, name)
        if name in heated:
            _draw_surfaces(column[-1], own, name)
        low, high = column[0].get_ylim()
        column[0].set_ylim(min(0.0, low), high + HEADROOM * (high - low))
        _draw_films(column[1], own, name)
        column[2].set_ylim(bottom=0.0)
        _set_logarithmic(column[3])
        _draw_levels(column[3])
        label_abscissa(column[len(rows if name in heated else ROWS) - 1], own)
        column[0].set_title(name.replace("_", " ") if len(names) > 1 else "", loc="left")
    add_legend_above(axes[0, -1])
    return figure


def _draw_films(ax: Axes, data: FigureData, name: str) -> None:
    """Draw central and minimum film, and the least minimum."""
    central, least = f"{name}.film_thickness", f"{name}.minimum_film_thickness"
    factor, _ = data.shown(central)
    ax.plot(data.x(), factor * data.coupled[central], color=MUTED, lw=1.0, label="central")
    k = int(np.nanargmin(data.coupled[least]))
    film = factor * data.coupled[least][k]
    ax.plot([data.x()[k]], [film], "o", ms=4.0, color=COUPLED, label=f"least {film:.3g} µm")
    _set_logarithmic(ax)
    handles, words = ax.get_legend_handles_labels()
    chosen = {text: handle for handle, text in zip(handles, words, strict=True)}
    chosen["minimum"] = chosen.pop("coupled")
    chosen.pop("monolithic reference", None)
    ax.legend(
        chosen.values(), chosen.keys(), fontsize=7.5, ncols=3, loc="lower right", bbox_to_anchor=(1.0, 0.98),
        borderaxespad=0.0,
    )  # fmt: skip


def _draw_surfaces(ax: Axes, data: FigureData, name: str) -> None:
    """Draw the hottest place of both surfaces and the oil's temperature beside that of the film; in °C."""
    hottest = np.nanmax(data.coupled[f"{name}.{HOT}"]) - FREEZING
    oil = data.parameters[f"{name}.oil_temperature"]
    (surfaces,) = ax.plot(data.x(), data.coupled[f"{name}.{SURFACE}"], color=MUTED, lw=1.0)
    entering = ax.axhline(oil, color=ACCENT, lw=0.8, ls=(0, (4, 2)))
    (film,) = (line for line in ax.lines if line.get_label() == data.names[0])
    words = (f"film, at most {hottest:.0f} °C", "surfaces", f"entering oil, {oil - FREEZING:.0f} °C")
    ax.legend(
        [film, surfaces, entering], words, fontsize=7.5, ncols=3, loc="lower right",
        bbox_to_anchor=(1.0, 0.98), borderaxespad=0.0,
    )  # fmt: skip
    low, high = ax.get_ylim()
    ticks = np.asarray(MaxNLocator(6, steps=[1, 2, 5, 10]).tick_values(low - FREEZING, high - FREEZING))
    ax.set_yticks(FREEZING + ticks, [f"{tick:g}" for tick in ticks])
    ax.set_ylim(low, high)
    ax.set_ylabel("Temperature (°C)")


def _draw_levels(ax: Axes) -> None:
    """Mark the film ratios of full and mixed films."""
    for level, words in ((EQUAL, "film = roughness"), (FULL, f"full film above {FULL:g}")):
        ax.axhline(level, color=ACCENT, lw=0.8, ls=(0, (4, 2)))
        ax.text(0.995, level, words, transform=ax.get_yaxis_transform(), ha="right",
                va="top" if level == EQUAL else "bottom", fontsize=7.0, color=ACCENT)  # fmt: skip
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, EQUAL / ROOM), max(high, FULL * ROOM))


def _set_logarithmic(ax: Axes) -> None:
    """Use a logarithmic scale with labels at 1, 2 and 5."""
    ax.set_yscale("log")
    ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    ax.yaxis.set_major_formatter(FormatStrFormatter("%g"))
    ax.yaxis.set_minor_formatter(NullFormatter())
