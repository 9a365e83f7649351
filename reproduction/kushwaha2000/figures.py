"""The source's Figs 2 to 8, with its numbering, over the cam angle in degrees (nose at 180)."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from orchestrator.plots.style import ACCENT, COUPLED, MUTED, REFERENCE, create_subplots

from ..publication import Drawing
from .runs import AS_PRINTED, KINEMATIC_SPEED, NEGATIVE, NOSE_DEG, SPEEDS, Runs

MICRO, MILLI = 1e6, 1e3
INK = "#333c46"
# One hue, darker with speed: the order of the curves is read without the legend.
SPEED_COLOURS = dict(zip(SPEEDS, ("#9bc4e2", "#5b9bd0", "#1f66a8", "#0a2f5c"), strict=True))
FILM_WORDS = {AS_PRINTED: "load exponent +0.059, as printed", NEGATIVE: "load exponent −0.059"}
# The source's own levels, from its section 5 (m).
STATED_FILMS = {"stated minimum 0.04 µm": 0.04e-6, "stated maximum 1.3 µm": 1.3e-6}


def _create_panels(rows: int, title: str, heights: Sequence[float] = ()) -> tuple[Figure, Any]:
    ratios = heights or [1.0] * rows
    size = (6.8, 0.85 + (2.5 if rows == 1 else 1.85 * sum(ratios)))
    figure, axes = create_subplots(
        rows, 1, sharex=True, squeeze=False, figsize=size, gridspec_kw={"height_ratios": ratios}
    )
    axes = axes[:, 0]
    figure.suptitle(title, x=0.012, ha="left", fontsize=10.5, fontweight="bold")
    axes[-1].set_xlabel("Cam angle [deg] (nose at 180)")
    axes[-1].set_xlim(0.0, 360.0)
    axes[-1].xaxis.set_major_locator(MultipleLocator(30.0))
    return figure, axes


def _mark_reversals(axes: Axes, runs: Runs) -> None:
    """Thin lines where the entraining velocity is zero."""
    for n, angle in enumerate(runs.reversals_deg):
        words = "u = 0" if n == 0 else None
        axes.axvline(angle, color=REFERENCE, lw=0.7, ls=(0, (2, 2)), zorder=0.5, label=words)


def _mark_zero(axes: Axes) -> None:
    axes.axhline(0.0, color=INK, lw=0.7)


def _add_legend(axes: Axes, columns: int) -> None:
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=columns, borderaxespad=0.2, handlelength=1.8
    )


def _plot_by_exponent(
    runs: Runs, title: str, label: str, columns: int, plot: Callable[[Axes, str], None]
) -> tuple[Figure, Any]:
    """A panel for each sign of the load's exponent."""
    figure, axes = _create_panels(2, title)
    for ax, (exponent, words) in zip(axes, FILM_WORDS.items(), strict=True):
        plot(ax, exponent)
        ax.set_ylabel(label)
        place = {"ha": "left", "va": "top", "fontsize": 8.5, "color": INK}
        ax.text(0.012, 0.95, words, transform=ax.transAxes, **place)
        _mark_reversals(ax, runs)
    _add_legend(axes[0], columns)
    return figure, axes


def plot_lift(runs: Runs) -> Figure:
    """Fig 2."""
    figure, axes = _create_panels(3, "Fig. 2  Cam lift, follower velocity and acceleration (1000 r/min)")
    angle = np.linspace(0.0, 360.0, 1801)
    profile = np.array([runs.lift(a) for a in angle])
    omega = KINEMATIC_SPEED * math.pi / 30.0
    rows = ((0, MILLI, "Lift [mm]"), (1, omega, "Velocity [m/s]"), (2, omega**2, "Acceleration [m/s²]"))
    for ax, (column, scale, label) in zip(axes, rows, strict=True):
        ax.plot(angle, scale * profile[:, column], color=COUPLED)
        ax.set_ylabel(label)
        if column:
            _mark_zero(ax)
    axes[0].set_ylim(bottom=0.0)
    axes[2].annotate(
        "spike at the nose", xy=(NOSE_DEG, 0.0), xytext=(NOSE_DEG, 0.72 * omega**2 * profile[:, 2].max()),
        ha="center", fontsize=8.5, color=INK, arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 0.8},
    )  # fmt: skip
    return figure


def plot_entraining_velocity(runs: Runs) -> Figure:
    """Fig 3."""
    figure, (ax,) = _create_panels(1, "Fig. 3  Entraining velocity")
    angle = np.linspace(0.0, 360.0, 1801)
    for speed, colour in SPEED_COLOURS.items():
        u = [runs.entraining(a, speed) for a in angle]
        ax.plot(angle, u, color=colour, label=f"{speed:.0f} r/min")
    _mark_zero(ax)
    _mark_reversals(ax, runs)
    ax.set_ylabel("Entraining velocity [m/s]")
    _add_legend(ax, len(SPEEDS) + 1)
    return figure


def plot_film(runs: Runs) -> Figure:
    """Fig 4."""

    def plot(ax: Axes, exponent: str) -> None:
        cycle = runs.kinematic(film=exponent)
        steady = MICRO * cycle["contact.steady_film_thickness"]
        ax.plot(cycle.angle_deg, steady, color=MUTED, lw=1.0, label="entraining motion alone")
        ax.plot(cycle.angle_deg, MICRO * cycle.film, color=COUPLED, label="entraining and squeeze")
        ax.set_ylim(0.0, 1.22 * MICRO * cycle.film.max())

    title = "Fig. 4  Film thickness, kinematic (1000 r/min)"
    figure, axes = _plot_by_exponent(runs, title, "Film thickness [µm]", 3, plot)
    for words, level in STATED_FILMS.items():
        axes[0].axhline(MICRO * level, color=ACCENT, lw=0.9, ls=(0, (5, 3)), zorder=0.6)
        place = {"ha": "right", "va": "bottom", "fontsize": 7.5, "color": ACCENT}
        axes[0].text(358.0, MICRO * level + 0.01, words, **place)
    return figure


def plot_squeeze_velocity(runs: Runs) -> Figure:
    """Fig 5."""

    def plot(ax: Axes, exponent: str) -> None:
        cycle = runs.kinematic(film=exponent)
        ax.plot(cycle.angle_deg, MILLI * cycle.squeeze, color=COUPLED)
        _mark_zero(ax)

    title = "Fig. 5  Squeeze velocity, kinematic (1000 r/min, + separates)"
    return _plot_by_exponent(runs, title, "Squeeze velocity [mm/s]", 1, plot)[0]


def plot_contact_load(runs: Runs) -> Figure:
    """Fig 6."""
    figure, (ax,) = _create_panels(1, "Fig. 6  Contact load with spring surge (r/min)")
    for speed, colour in SPEED_COLOURS.items():
        cycle = runs.surge(speed)
        ax.plot(cycle.angle_deg, cycle.load, color=colour, label=f"{speed:.0f}")
    plain, words = runs.kinematic(SPEEDS[-1]), f"{SPEEDS[-1]:.0f}, no surge"
    ax.plot(plain.angle_deg, plain.load, color=ACCENT, lw=1.0, ls=(0, (4, 2)), label=words)
    _mark_reversals(ax, runs)
    ax.set_ylabel("Contact load [N]")
    ax.set_ylim(bottom=0.0)
    _add_legend(ax, len(SPEEDS) + 2)
    return figure


def plot_films(runs: Runs) -> Figure:
    """Fig 7."""

    def plot(ax: Axes, exponent: str) -> None:
        for speed, colour in SPEED_COLOURS.items():
            cycle = runs.surge(speed, exponent)
            ax.plot(cycle.angle_deg, MICRO * cycle.film, color=colour, label=f"{speed:.0f} r/min")
        ax.set_ylim(0.0, 1.22 * ax.get_ylim()[1])

    title = "Fig. 7  Film thickness with spring surge"
    return _plot_by_exponent(runs, title, "Film thickness [µm]", len(SPEEDS) + 1, plot)[0]


def plot_flexible_load(runs: Runs) -> Figure:
    """Fig 8."""
    figure, axes = _create_panels(2, "Fig. 8  Contact load at 600 r/min, flexible camshaft", (1.0, 1.25))
    rigid = runs.surge(600.0)
    axes[0].plot(rigid.angle_deg, rigid.load, color=MUTED, lw=3.0, alpha=0.6, label="rigid")
    for length, colour in ((100.0, COUPLED), (200.0, REFERENCE)):
        cycle = runs.flexible(600.0, length)
        axes[0].plot(cycle.angle_deg, cycle.load, color=colour, lw=1.0, label=f"l = {length:.0f} mm")
        axes[1].plot(cycle.angle_deg, cycle.load - rigid.load, color=colour, lw=1.0)
    _mark_zero(axes[1])
    axes[0].set_ylabel("Contact load [N]")
    axes[1].set_ylabel("Difference from\nrigid camshaft [N]")
    _add_legend(axes[0], 3)
    return figure


PLOTS: Mapping[int, tuple[Callable[[Runs], Figure], str]] = {
    2: (plot_lift, "Lift, velocity and acceleration characteristics of the cycloidal cam"),
    3: (plot_entraining_velocity, "Entraining velocity at different camshaft speeds"),
    4: (plot_film, "Lubricant film thickness at the point of contact"),
    5: (plot_squeeze_velocity, "Squeeze velocity at the point of contact"),
    6: (plot_contact_load, "Contact load variation at different speeds"),
    7: (plot_films, "Lubricant film thickness at different camshaft speeds"),
    8: (plot_flexible_load, "Contact load variation at 600 r/min owing to camshaft elasticity"),
}
FIGURES = [
    Drawing(f"kushwaha2000-fig{number}.png", plot, f"Fig. {number}: {caption}")
    for number, (plot, caption) in PLOTS.items()
]
