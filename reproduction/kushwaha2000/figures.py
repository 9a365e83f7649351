"""The source's Figs 2 to 8, with its numbering, over the cam angle in degrees (nose at 180)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from orchestrator.plots.style import ACCENT, COUPLED, MUTED, REFERENCE, subplots

from ..pictures import compact
from .runs import AS_PRINTED, KINEMATIC_SPEED, NEGATIVE, NOSE_DEG, SPEEDS, Runs

PREFIX = "kushwaha2000-fig"
MICRO, MILLI = 1e6, 1e3
INK = "#333c46"
# One hue, darker with speed: the order of the curves is read without the legend.
SPEED_COLOURS = dict(zip(SPEEDS, ("#9bc4e2", "#5b9bd0", "#1f66a8", "#0a2f5c"), strict=True))
FILM_WORDS = {AS_PRINTED: "load exponent +0.059, as printed", NEGATIVE: "load exponent −0.059"}
# The source's own levels, from its section 5 (m).
STATED_FILMS = {"stated minimum 0.04 µm": 0.04e-6, "stated maximum 1.3 µm": 1.3e-6}


def draw(runs: Runs, folder: Path) -> list[Path]:
    """Draw every figure into `folder`."""
    return [
        compact(partial(make, runs), folder / f"{PREFIX}{number}.png") for number, make in FIGURES.items()
    ]


def _panels(rows: int, title: str, heights: Sequence[float] | None = None) -> tuple[Figure, Any]:
    ratios = heights or [1.0] * rows
    size = (6.8, 0.85 + (2.5 if rows == 1 else 1.85 * sum(ratios)))
    figure, axes = subplots(
        rows, 1, sharex=True, squeeze=False, figsize=size, gridspec_kw={"height_ratios": ratios}
    )
    axes = axes[:, 0]
    figure.suptitle(title, x=0.012, ha="left", fontsize=10.5, fontweight="bold")
    axes[-1].set_xlabel("Cam angle [deg] (nose at 180)")
    axes[-1].set_xlim(0.0, 360.0)
    axes[-1].xaxis.set_major_locator(MultipleLocator(30.0))
    figure.align_ylabels(axes)
    return figure, axes


def _reversals(axes: Axes, runs: Runs) -> None:
    """Thin lines where the entraining velocity is zero."""
    for n, angle in enumerate(runs.reversals_deg):
        words = "u = 0" if n == 0 else None
        axes.axvline(angle, color=REFERENCE, lw=0.7, ls=(0, (2, 2)), zorder=0.5, label=words)


def _zero(axes: Axes) -> None:
    axes.axhline(0.0, color=INK, lw=0.7)


def _within(axes: Axes, text: str, place: str = "left") -> None:
    """A panel's caption in its upper corner."""
    x = {"left": 0.012, "right": 0.988}[place]
    axes.text(x, 0.95, text, transform=axes.transAxes, ha=place, va="top", fontsize=8.5, color=INK)


def _legend(axes: Axes, columns: int) -> None:
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=columns, borderaxespad=0.2, handlelength=1.8
    )


def plot_lift(runs: Runs) -> Figure:
    """Fig 2."""
    figure, axes = _panels(3, f"Fig. 2  Cam lift, follower velocity and acceleration ({_rpm(1000.0)})")
    angle = np.linspace(0.0, 360.0, 1801)
    profile = np.array([runs.lift(a) for a in angle])
    omega = KINEMATIC_SPEED * math.pi / 30.0
    rows = ((0, MILLI, "Lift [mm]"), (1, omega, "Velocity [m/s]"), (2, omega**2, "Acceleration [m/s²]"))
    for ax, (column, scale, label) in zip(axes, rows, strict=True):
        ax.plot(angle, scale * profile[:, column], color=COUPLED)
        ax.set_ylabel(label)
        if column:
            _zero(ax)
    axes[0].set_ylim(bottom=0.0)
    axes[2].annotate(
        "spike at the nose", xy=(NOSE_DEG, 0.0), xytext=(NOSE_DEG, 0.72 * omega**2 * profile[:, 2].max()),
        ha="center", fontsize=8.5, color=INK, arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 0.8},
    )  # fmt: skip
    return figure


def plot_entraining_velocity(runs: Runs) -> Figure:
    """Fig 3."""
    figure, (ax,) = _panels(1, "Fig. 3  Entraining velocity")
    angle = np.linspace(0.0, 360.0, 1801)
    for speed in SPEEDS:
        u = [runs.entraining(a, speed) for a in angle]
        ax.plot(angle, u, color=SPEED_COLOURS[speed], label=_rpm(speed))
    _zero(ax)
    _reversals(ax, runs)
    ax.set_ylabel("Entraining velocity [m/s]")
    _legend(ax, len(SPEEDS) + 1)
    return figure


def plot_film(runs: Runs) -> Figure:
    """Fig 4."""
    figure, axes = _panels(2, f"Fig. 4  Film thickness, kinematic ({_rpm(KINEMATIC_SPEED)})")
    for ax, exponent in zip(axes, FILM_WORDS, strict=True):
        cycle = runs.kinematic(film=exponent)
        steady = MICRO * cycle["contact.steady_film_thickness"]
        ax.plot(cycle.angle_deg, steady, color=MUTED, lw=1.0, label="entraining motion alone")
        ax.plot(cycle.angle_deg, MICRO * cycle.film, color=COUPLED, label="entraining and squeeze")
        ax.set_ylabel("Film thickness [µm]")
        ax.set_ylim(0.0, 1.22 * MICRO * cycle.film.max())
        _within(ax, FILM_WORDS[exponent])
        _reversals(ax, runs)
    for words, level in STATED_FILMS.items():
        axes[0].axhline(MICRO * level, color=ACCENT, lw=0.9, ls=(0, (5, 3)), zorder=0.6)
        place = {"ha": "right", "va": "bottom", "fontsize": 7.5, "color": ACCENT}
        axes[0].text(358.0, MICRO * level + 0.01, words, **place)
    _legend(axes[0], 3)
    return figure


def plot_squeeze_velocity(runs: Runs) -> Figure:
    """Fig 5."""
    figure, axes = _panels(2, f"Fig. 5  Squeeze velocity, kinematic ({_rpm(KINEMATIC_SPEED)}, + separates)")
    for ax, exponent in zip(axes, FILM_WORDS, strict=True):
        cycle = runs.kinematic(film=exponent)
        ax.plot(cycle.angle_deg, MILLI * cycle.squeeze, color=COUPLED)
        _zero(ax)
        ax.set_ylabel("Squeeze velocity [mm/s]")
        _within(ax, FILM_WORDS[exponent])
        _reversals(ax, runs)
    _legend(axes[0], 1)
    return figure


def plot_contact_load(runs: Runs) -> Figure:
    """Fig 6."""
    figure, (ax,) = _panels(1, "Fig. 6  Contact load with spring surge (r/min)")
    massless = runs.kinematic(SPEEDS[-1])
    for speed in SPEEDS:
        cycle = runs.surge(speed)
        ax.plot(cycle.angle_deg, cycle.load, color=SPEED_COLOURS[speed], label=f"{speed:.0f}")
    words = f"{SPEEDS[-1]:.0f}, no surge"
    ax.plot(massless.angle_deg, massless.load, color=ACCENT, lw=1.0, ls=(0, (4, 2)), label=words)
    _reversals(ax, runs)
    ax.set_ylabel("Contact load [N]")
    ax.set_ylim(bottom=0.0)
    _legend(ax, len(SPEEDS) + 2)
    return figure


def plot_films(runs: Runs) -> Figure:
    """Fig 7."""
    figure, axes = _panels(2, "Fig. 7  Film thickness with spring surge")
    for ax, exponent in zip(axes, FILM_WORDS, strict=True):
        for speed in SPEEDS:
            cycle = runs.surge(speed, exponent)
            ax.plot(cycle.angle_deg, MICRO * cycle.film, color=SPEED_COLOURS[speed], label=_rpm(speed))
        ax.set_ylabel("Film thickness [µm]")
        ax.set_ylim(0.0, 1.22 * ax.get_ylim()[1])
        _within(ax, FILM_WORDS[exponent])
        _reversals(ax, runs)
    _legend(axes[0], len(SPEEDS) + 1)
    return figure


def plot_flexible_load(runs: Runs) -> Figure:
    """Fig 8."""
    figure, axes = _panels(2, "Fig. 8  Contact load at 600 r/min, flexible camshaft", (1.0, 1.25))
    rigid = runs.surge(600.0)
    axes[0].plot(rigid.angle_deg, rigid.load, color=MUTED, lw=3.0, alpha=0.6, label="rigid")
    for length, colour in ((100.0, COUPLED), (200.0, REFERENCE)):
        cycle = runs.flexible(600.0, length)
        axes[0].plot(cycle.angle_deg, cycle.load, color=colour, lw=1.0, label=f"l = {length:.0f} mm")
        axes[1].plot(cycle.angle_deg, cycle.load - rigid.load, color=colour, lw=1.0)
    _zero(axes[1])
    axes[0].set_ylabel("Contact load [N]")
    axes[1].set_ylabel("Difference from\nrigid camshaft [N]")
    _legend(axes[0], 3)
    return figure


def _rpm(speed: float) -> str:
    return f"{speed:.0f} r/min"


FIGURES: Mapping[int, Callable[[Runs], Figure]] = {
    2: plot_lift,
    3: plot_entraining_velocity,
    4: plot_film,
    5: plot_squeeze_velocity,
    6: plot_contact_load,
    7: plot_films,
    8: plot_flexible_load,
}
CAPTIONS: Mapping[int, str] = {
    2: "Lift, velocity and acceleration characteristics of the cycloidal cam",
    3: "Entraining velocity at different camshaft speeds",
    4: "Lubricant film thickness at the point of contact",
    5: "Squeeze velocity at the point of contact",
    6: "Contact load variation at different speeds",
    7: "Lubricant film thickness at different camshaft speeds",
    8: "Contact load variation at 600 r/min owing to camshaft elasticity",
}
