"""Figures: films through the cam cycle, formulas over Table 3."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, MultipleLocator, NullFormatter

from models.core.quantities import Vector
from orchestrator.plots.style import ACCENT, COUPLED, MUTED, REFERENCE, create_subplots

from ..publication import Drawing
from .cam import EVENT_DEG, SQUEEZED, STEADY, CamCycle, Flags
from .formulas import CENTRAL, FORMULAS, MINIMUM, Formula
from .runs import Runs

# Of the figures with many panels.
DPI = 105.0
INK, AMBER, VIOLET = "#22282f", "#c77d11", "#8a5bb5"
COLOURS = {
    "kushwaha": REFERENCE,
    "kushwaha_negative": VIOLET,
    "dowson_toyoda": ACCENT,
    "pan_hamrock_central": COUPLED,
    "dowson_higginson": ACCENT,
    "pan_hamrock_minimum": COUPLED,
    "moes_venner": AMBER,
}
MICRO = 1e6
# Ratios of either film that are drawn, and their ticks.
LIMITS = {CENTRAL: (0.5, 10.0), MINIMUM: (0.78, 1.3)}
TICKS = {CENTRAL: (0.7, 1.0, 1.4, 2.0, 5.0, 10.0), MINIMUM: (0.9, 1.0, 1.1, 1.2, 1.3)}
# Bars of the conditions: their height, and the first's place above the panel's foot (shares of the panel).
BAR, FOOT = 0.028, 0.02


def plot_cycles(found: Sequence[CamCycle]) -> Figure:
    """A row for each speed: numerical films; films over the transient one, central and minimum."""
    rows = len(found)
    title = "Films through the cam's event: numerical, and formulas over the transient numerical film"
    figure, axes = create_subplots(rows, 3, title, (11.5, 1.4 + 2.2 * rows), sharex=True, squeeze=False)
    for row, c in zip(axes, found, strict=True):
        _draw_films(row[0], c)
        for ax, film in zip(row[1:], (CENTRAL, MINIMUM), strict=True):
            _draw_ratios(ax, c, film)
        row[0].set_ylabel(f"{c.speed_rpm:.0f} r/min\nFilm [µm]")
    titles = (
        "numerical films",
        "over the transient central film (bars: conditions do not hold)",
        "over the transient minimum film (bars: as before)",
    )
    for ax, title in zip(axes[0], titles, strict=True):
        ax.set_title(title, loc="left", fontsize=8.5, pad=50.0)
        ax.legend(
            loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=2, fontsize=7.5, handlelength=1.8,
            columnspacing=1.0, labelspacing=0.3, borderaxespad=0.1,
        )  # fmt: skip
    for ax in axes[-1]:
        ax.set_xlabel("Cam angle [deg] (nose at 180)")
        ax.xaxis.set_major_locator(MultipleLocator(30.0))
        ax.set_xlim(*EVENT_DEG)
    return figure


def _draw_films(ax: Axes, c: CamCycle) -> None:
    inside, history = c.in_event, c.history
    looks = ((CENTRAL, history.film_thickness, INK), (MINIMUM, history.minimum_film_thickness, COUPLED))
    for film, values, colour in looks:
        ax.plot(c.history_deg[inside], MICRO * values[inside], color=colour, label=f"{film}, transient")
        ax.plot(c.angle_deg, MICRO * c.steady[film], color=colour, lw=0.9, ls=(0, (3, 1.5)),
                label=f"{film}, steady")  # fmt: skip
    least, angle = c.least
    ax.plot([angle], [0.88 * MICRO * least], "^", color=REFERENCE, ms=5.0, label="least of the event")
    ax.set_yscale("log")
    ax.set_ylim(0.03, 3.5)
    ax.set_yticks([0.05, 0.1, 0.2, 0.5, 1.0, 2.0])
    _label_plainly(ax)


def _draw_ratios(ax: Axes, c: CamCycle, film: str) -> None:
    chosen = [(name, judged) for name, judged in c.judged.items() if judged.film == film]
    bars = 0
    for name, judged in chosen:
        formula = name.removesuffix(f" {SQUEEZED}")
        steady, squeezed = name.startswith(STEADY), name != formula
        colour = MUTED if steady else COLOURS[formula]
        ratio = c.ratio(name)
        style = (0, (4, 1.2)) if squeezed else "-"
        width = 2.2 if steady else 1.2
        inside = np.where(judged.valid, ratio, np.nan)
        ax.plot(c.angle_deg, ratio, color=colour, lw=0.8, ls=(0, (1, 1.5)))
        ax.plot(c.angle_deg, inside, color=colour, lw=width, ls=style, label=judged.label)
        if not steady and not squeezed:
            _draw_bar(ax, c.angle_deg, ~judged.valid, colour, bars)
            bars += 1
    ax.axhline(1.0, color=INK, lw=0.7, zorder=0.5)
    ax.set_yscale("log")
    ax.set_ylim(*LIMITS[film])
    ax.set_yticks(TICKS[film])
    _label_plainly(ax)


def _draw_bar(ax: Axes, angle: Vector, outside: Flags, colour: str, row: int) -> None:
    """A bar at the foot of the panel over the angles where conditions do not hold."""
    foot = FOOT + 1.4 * BAR * row
    ax.fill_between(
        angle, foot, foot + BAR, where=outside, color=colour, lw=0.0, step="mid",
        transform=ax.get_xaxis_transform(),
    )  # fmt: skip


def _label_plainly(ax: Axes) -> None:
    ax.yaxis.set_major_formatter(FormatStrFormatter("%g"))
    ax.yaxis.set_minor_formatter(NullFormatter())


def plot_table_3(runs: Runs) -> Figure:
    """Ratio to the numerical central film over M: steady, and with squeeze for Kushwaha's formula."""
    title = "Formulas over the numerical central film, contacts of Kushwaha's Table 3"
    figure, axes = create_subplots(1, 2, title, (8.6, 3.4), sharey=True)
    central = [formula for formula in FORMULAS if formula.film == CENTRAL]
    for formula in central:
        _draw_points(axes[0], runs.sample.M, runs.sample.over_numerical(formula), formula)
    for formula in central[:2]:
        _draw_points(axes[1], runs.sample.M, runs.sample.squeezed_over_numerical(formula), formula)
    for ax, words in zip(axes, ("steady", "with squeeze, −0.005 < w_s < 0"), strict=True):
        ax.axhline(1.0, color=INK, lw=0.9)
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_xlabel("M")
        ax.set_title(words, loc="left", fontsize=9)
        ax.yaxis.set_major_formatter(FormatStrFormatter("%g"))
        ax.yaxis.set_minor_formatter(NullFormatter())
        ax.set_yticks([0.5, 1.0, 2.0, 5.0, 10.0])
    axes[0].set_ylabel("Formula / numerical")
    axes[0].legend(fontsize=7.5, markerscale=1.8)
    return figure


def _draw_points(ax: Axes, x: Vector, y: Vector, formula: Formula) -> None:
    ax.plot(x, y, ".", ms=3.2, color=COLOURS[formula.name], label=formula.label)


FIGURES = [
    Drawing[Runs](
        "films-cycle.png", lambda runs: plot_cycles(runs.cycles),
        "Transient and steady numerical films through the cam's event, and other films over the transient "
        "one; dotted, with a bar below, where their conditions do not hold", DPI,
    ),
    Drawing[Runs](
        "films-table-3.png", plot_table_3,
        "Formulas over the numerical central film, at contacts sampled over Kushwaha's Table 3",
    ),
]  # fmt: skip
