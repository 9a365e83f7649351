"""Macro steps: how long they were, what limited them, their errors and iterations, over time and in sum."""

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, MaxNLocator

from models.core.quantities import Vector

from ..assessment.diagnosis.steps import Steps
from ..assessment.diagnosis.suggestions import percent
from ..engine.step import REASONS
from ..scenario.display import SYMBOLS
from ..scenario.units import choose_time_unit
from .data import FigureData
from .style import ACCENT, MUTED, REFERENCE, create_subplots

# Steps drawn of each kind at most: more cannot be told apart.
DRAWN = 20_000
# Steps below this share of the time are drawn as dots.
VISIBLE = 2e-3
# Steps with rejected attempts that are marked one by one; more are shaded, in so many spans.
MARKS, SHADES = 300, 300
# Variables whose error limits steps, each in a colour of its own; the others share one.
VARIABLES = ("#0b5fa5", "#e08e0b", "#7b4fa3", "#17a2b8")
OTHERS = "#b8c4cf"
# What limited a step otherwise: words and colour. Common ones are drawn first, rare ones on top.
KINDS = {
    "fixed": ("macro_step", "#4f6d7a"),
    "maximum_step": ("maximum_step", MUTED),
    "growth": ("growth from a shorter step", "#8c9a3a"),
    "stop_time": ("stop time", "#444444"),
    "convergence": ("no convergence before", "#a0522d"),
    "discard": ("refused before", "#d977c3"),
    "time_event": ("time event", "#7ac29a"),
    "event": ("event located", ACCENT),
    "discontinuity": ("discontinuity", REFERENCE),
}
# Longest over shortest step, up to which a linear scale tells more than a logarithmic one.
EVEN = 1.5
# The first macro steps differ, while the polynomials of the signals gather their past.
BEGINNING = 3
SMALLEST = 1e-6  # of the allowed error: below, estimates are rounding

# Colours, and which steps have each.
Kinds = list[tuple[str, Any]]


def applies(data: FigureData) -> bool:
    """Whether the steps differ."""
    steps = data.steps
    if len(steps) < 2:
        return False
    even = np.ptp(steps.length[:-1]) <= 1e-6 * steps.length[0]
    alike = np.ptp(steps.iterations[BEGINNING:]) == 0 if len(steps) > BEGINNING else True
    return not (even and alike and not steps.rejected.any())


def draw(data: FigureData) -> Figure:
    return draw_steps(data.steps, data.title)


def draw_steps(steps: Steps, title: str) -> Figure:
    """Draw these steps, without empty panels."""
    judged = bool(np.any(steps.error > 0.0))
    iterated = bool(steps.iterations.max() > 1)
    heights = [2.6] + [1.5] * judged + [1.7] * iterated
    shape: dict[str, Any] = {"sharey": "row", "width_ratios": [4, 1], "height_ratios": heights}
    size = (7.6, 1.5 + sum(heights))
    figure, axes = create_subplots(len(heights), 2, f"{title}: macro steps", size, squeeze=False, **shape)
    kinds, entries = _assign_colours(steps)
    rows: Any = iter(axes)
    ax, side = next(rows)
    _draw_lengths(ax, side, steps, kinds)
    if judged:
        ax, side = next(rows)
        _draw_errors(ax, side, steps, kinds)
    if iterated:
        ax, side = next(rows)
        _draw_counts(ax, side, steps, kinds)
    for ax in axes[:, 0]:
        ax.set_xlim(steps.start[0], steps.end[-1])
    for ax in axes[:-1, 0]:
        ax.tick_params(labelbottom=False)
    unit, factor = choose_time_unit(steps.end[-1] - steps.start[0])
    axes[-1, 0].set_xlabel(f"Time ({SYMBOLS.get(unit, unit)})")
    axes[-1, 0].xaxis.set_major_formatter(FuncFormatter(lambda time, _: f"{factor * time:.10g}"))
    axes[-1, 1].set_xlabel("Share of steps (%)")
    longest = max(len(str(entry.get_label())) for entry in entries)
    figure.legend(handles=entries, loc="outside lower left", ncols=3 if longest < 34 else 2, handlelength=1.4)
    return figure


def _assign_colours(steps: Steps) -> tuple[Kinds, list[Line2D]]:
    """The steps of each colour, most frequent first, and the legend."""
    limited = steps.reason == REASONS.index("error")
    sources, counts = np.unique(steps.source[limited], return_counts=True)
    sources = sources[np.argsort(-counts)]
    kinds = [
        (f"error of {steps.name(int(source))}", colour, limited & (steps.source == source))
        for source, colour in zip(sources, VARIABLES, strict=False)
    ]
    if len(sources) > len(VARIABLES):
        rest = limited & np.isin(steps.source, sources[len(VARIABLES) :])
        kinds.append(("error of others", OTHERS, rest))
    kinds += [(words, colour, steps.reason == REASONS.index(name)) for name, (words, colour) in KINDS.items()]
    kinds = [kind for kind in kinds if kind[2].any()]
    entries = [
        Line2D([], [], color=colour, lw=3.0, label=f"{words}: {percent(np.mean(chosen))}")
        for words, colour, chosen in kinds
    ]
    if steps.rejected.any():
        shaded = " (shaded)" if np.count_nonzero(steps.rejected) > MARKS else ""
        label = f"rejected attempts: {steps.rejected.sum()}{shaded}"
        entries.append(Line2D([], [], color="black", marker="|", ls="", ms=7.0, label=label))
    return [kind[1:] for kind in kinds], entries


def _draw_bars(ax: Axes, steps: Steps, values: Vector, kinds: Kinds) -> None:
    """Draw each step as a bar from start to end, a very short one as a dot."""
    width = 2.4 if len(steps) < 1000 else 1.6
    visible = steps.length > VISIBLE * (steps.end[-1] - steps.start[0])
    for colour, chosen in kinds:
        at = np.flatnonzero(chosen)
        at = at[:: -(-len(at) // DRAWN)]
        bars, dots = at[visible[at]], at[~visible[at]]
        ends = np.stack([steps.start[bars], steps.end[bars]], axis=1)
        level = np.repeat(values[bars, None], 2, axis=1)
        segments = list(np.stack([ends, level], axis=2))
        ax.add_collection(LineCollection(segments, colors=colour, lw=width, rasterized=True))
        ax.plot(steps.end[dots], values[dots], "o", color=colour, ms=width, mew=0.0, rasterized=True)


def _draw_lengths(ax: Axes, sums: Axes, steps: Steps, kinds: Kinds) -> None:
    _draw_bars(ax, steps, steps.length, kinds)
    low, high = float(steps.length.min()), float(steps.length.max())
    if high > EVEN * low:
        # Limits first: those of a scale that fits itself to one value alone would be a single number.
        ax.set_ylim(low / 1.6, high * 3.0)  # room for the marks of rejected attempts
        ax.set_yscale("log")
    else:
        ax.set_ylim(0.0, 1.5 * high)
    ax.set_ylabel("Step length (s)")
    _draw_rejected(ax, steps)
    # Bins of a tenth at least, the first about the shortest: lengths that are equal to rounding are one bar.
    ratio = max(1.1, (high / low) ** (1.0 / 30.0))
    count = 2 + math.ceil(math.log(high / low) / math.log(ratio))
    _draw_sums(sums, steps.length, low * ratio ** (np.arange(count) - 0.5), kinds)


def _draw_rejected(ax: Axes, steps: Steps) -> None:
    """Mark each step with rejected attempts above the panel, or shade their share if many."""
    at = np.flatnonzero(steps.rejected)
    if len(at) <= MARKS:
        ax.plot(
            steps.start[at], np.full(len(at), 0.955), "|", color="black", ms=7.0, mew=0.7,
            transform=ax.get_xaxis_transform(),
        )  # fmt: skip
        return
    edges = np.linspace(steps.start[0], steps.end[-1], SHADES + 1)
    attempts, _ = np.histogram(steps.end, edges, weights=1.0 + steps.rejected)
    rejected, _ = np.histogram(steps.end, edges, weights=steps.rejected)
    share = np.divide(rejected, attempts, out=np.zeros(SHADES), where=attempts > 0.0)
    ax.pcolormesh(
        edges, [0.935, 0.975], share[None, :], cmap="Greys", vmin=0.0, vmax=1.0,
        transform=ax.get_xaxis_transform(), rasterized=True,
    )  # fmt: skip


def _draw_errors(ax: Axes, sums: Axes, steps: Steps, kinds: Kinds) -> None:
    shown = np.maximum(steps.error.astype(float), SMALLEST)
    _draw_bars(ax, steps, shown, kinds)
    ax.axhline(1.0, color="#444444", lw=0.8)
    top = max(3.0, 2.0 * float(shown.max()))
    low = max(SMALLEST, 0.3 * float(np.quantile(shown, 0.005)))
    ax.set_ylim(low, top)
    ax.set_yscale("log")
    ax.set_ylabel("Error / allowed")
    _draw_sums(sums, np.clip(shown, low, top), np.geomspace(low, top, 31), kinds)


def _draw_counts(ax: Axes, sums: Axes, steps: Steps, kinds: Kinds) -> None:
    _draw_bars(ax, steps, steps.iterations.astype(float), kinds)
    if len(steps) > 10 * SHADES:
        edges = np.linspace(steps.start[0], steps.end[-1], SHADES + 1)
        total_steps, _ = np.histogram(steps.end, edges)
        total, _ = np.histogram(steps.end, edges, weights=steps.iterations)
        mean = np.divide(total, total_steps, out=np.full(SHADES, np.nan), where=total_steps > 0)
        ax.stairs(mean, edges, color="black", lw=1.0, baseline=None)
    most = int(steps.iterations.max())
    ax.set_ylim(0.0, most + 0.8)
    ax.set_ylabel("Iterations")
    ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    _draw_sums(sums, steps.iterations, np.arange(0.5, most + 1.0), kinds)


def _draw_sums(ax: Axes, values: Vector, edges: Any, kinds: Kinds) -> None:
    """Draw a histogram stacked by colour."""
    parts = [values[chosen] for _, chosen in kinds]
    share = [np.full(len(part), 100.0 / len(values)) for part in parts]
    colours = [colour for colour, _ in kinds]
    ax.hist(
        parts, bins=edges, weights=share, color=colours, stacked=True, orientation="horizontal", rwidth=0.9
    )
    ax.tick_params(labelleft=False)
