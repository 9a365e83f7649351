"""Figures of merit: what moves them, their scatter with its limits, and which tolerance it comes from."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from models.core.quantities import Vector

from .style import COUPLED, MUTED, REFERENCE, create_grid

COLUMNS, MOST_BARS = 2, 8
# Room on both sides of a histogram and above it, as a part of its size; what lies further out is written.
# Its marks have room for numbers of many digits.
MARGIN, MARKS = 0.3, 5


class Panel(NamedTuple):
    """A figure of merit: its head with the unit, its values, its limits and whether they are upper ones, and
    mean and deviation of first order."""

    head: str
    values: Vector
    limits: Sequence[tuple[float, bool]]
    linear: tuple[float, float]


def draw_histograms(panels: Sequence[Panel], title: str) -> Figure:
    """A panel for each: red where a limit is not kept; the line is the normal distribution of first order."""
    figure, places = create_grid(len(panels), COLUMNS, title, (10.0, 2.5), 0.6)
    for place, panel in zip(places, panels, strict=True):
        known = panel.values[np.isfinite(panel.values)]
        edges = np.histogram_bin_edges(known, "auto")
        counts, edges = np.histogram(known, edges)
        middle = 0.5 * (edges[1:] + edges[:-1])
        outside = np.zeros(middle.size, dtype=bool)
        for value, upper in panel.limits:
            outside |= middle > value if upper else middle < value
        colours = np.where(outside, REFERENCE, COUPLED)
        place.bar(middle, counts, width=np.diff(edges), color=list(colours))
        mean, deviation = panel.linear
        if deviation > 0.0:
            density = np.exp(-0.5 * ((middle - mean) / deviation) ** 2) / (deviation * np.sqrt(2.0 * np.pi))
            place.plot(middle, density * known.size * np.diff(edges), color=MUTED, label="first order")
            place.set_ylim(0.0, (1.0 + MARGIN) * max(counts.max(), place.get_ylim()[1] / 1.05))
            place.legend(loc="upper right")
        place.xaxis.set_major_locator(MaxNLocator(MARKS))
        place.yaxis.set_major_locator(MaxNLocator(MARKS, integer=True))
        room = MARGIN * (edges[-1] - edges[0])
        place.set_xlim(edges[0] - room, edges[-1] + room)
        for value, upper in panel.limits:
            if edges[0] - room < value < edges[-1] + room:
                place.axvline(value, color="black", linestyle="--", linewidth=1.0)
            else:
                text, far = f"limit {'<' if upper else '>'} {value:.4g}", value > edges[-1]
                marked = f"{text} →" if far else f"← {text}"
                place.set_title(marked, loc="right" if far else "left", fontsize=9.0)
        place.set_xlabel(panel.head)
        place.set_ylabel("trains")
    return figure


def draw_indices(dataset: xarray.Dataset, title: str) -> Figure:
    """A panel for each figure: first and total indices of the factors, the largest first."""
    names = [str(name) for name in dataset["figure"].values]
    figure, places = create_grid(len(names), COLUMNS, title, (10.0, 2.5), 0.6)
    for place, name in zip(places, names, strict=True):
        own = dataset.sel(figure=name)
        total = np.nan_to_num(own["total"].sel(end="value").values)
        order = np.argsort(-total, kind="stable")[:MOST_BARS][::-1]
        heads, at = [str(dataset["factor"].values[k]) for k in order], np.arange(order.size)
        for kind, shift, colour in (("total", -0.2, MUTED), ("first", 0.2, COUPLED)):
            value, low, high = (own[kind].sel(end=end).values[order] for end in ("value", "low", "high"))
            errors = np.clip([value - low, high - value], 0.0, None)
            place.barh(at + shift, value, height=0.38, color=colour, xerr=errors, label=kind)
        place.set_yticks(at, heads)
        place.grid(axis="y", visible=False)
        part, _, number = name.rpartition(".")
        place.set_title(f"{part}: {number.replace('_', ' ')}")
        place.set_xlim(-0.05, 1.1)
    places[0].legend(loc="lower right")
    return figure


# An elasticity below this is none.
LEAST = 1e-3


def draw_tornado(dataset: xarray.Dataset, title: str) -> Figure:
    """A panel for each figure: its change in % for 1 % more of each parameter; red where it falls. All panels
    have one scale. The coordinates `shown` and `size` say the values of figures and parameters."""
    title = f"{title}: change in % for 1 % more of a parameter"
    figure, panels = create_grid(dataset.sizes["figure"], COLUMNS, title, (10.0, 2.3), 0.6, sharex=True)
    for panel, name in zip(panels, dataset["figure"].values, strict=True):
        values = np.nan_to_num(dataset["elasticity"].sel(figure=name).values)
        order = np.argsort(-np.abs(values), kind="stable")[:MOST_BARS][::-1]
        colours = [COUPLED if values[k] >= 0.0 else REFERENCE for k in order]
        names = [f"{dataset['parameter'].values[k]}, {dataset['size'].values[k]}" for k in order]
        said = [f"{values[k]:.2g}" if abs(values[k]) >= LEAST else "0" for k in order]
        panel.bar_label(panel.barh(names, values[order], color=colours), said, padding=2, fontsize=7)
        panel.axvline(0.0, color="black", linewidth=0.8)
        panel.grid(axis="y", visible=False)
        part, _, number = str(name).rpartition(".")
        value = dataset["shown"].sel(figure=name).item()
        panel.set_title(f"{part}: {number.replace('_', ' ')}, {value}", loc="right")
        panel.margins(x=0.15)
    return figure
