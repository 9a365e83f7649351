"""The figure of pressure and film across the contact, at instants of the event and all through it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure

from models.core.quantities import Vector
from orchestrator.plots.style import COUPLED, REFERENCE, add_title

from .cam import CamCycle

MICRO, GIGA = 1e6, 1e-9
# Cam angles relative to the first reversal (degrees), and what is seen there.
BEFORE, AT, TRAPPED, LEAVING, AFTER = -2.0, 0.0, 1.0, 3.0, 6.0
# Largest |x| in profiles and maps (µm).
PROFILE, WIDTH = 250.0, 150.0
# Points of the maps: every so many angles of the history, and rows over x.
EVERY, ROWS = 2, 241
# Steps of colour of the film's map (µm) and the pressure's (GPa).
FILMS = (0.08, 0.1, 0.125, 0.16, 0.2, 0.25, 0.32, 0.4, 0.5, 0.63, 0.8, 1.0, 1.25)
PRESSURES = (0.0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6)
MAP_DEG = (130.0, 230.0)


def plot_field(c: CamCycle) -> Figure:
    """Profiles at six instants; maps of pressure and film over cam angle and x."""
    figure = Figure(figsize=(11.0, 9.0))
    add_title(figure, f"Pressure and film across the contact at {c.speed_rpm:.0f} r/min (transient)")
    halves: Any = figure.subfigures(2, 1, height_ratios=(1.15, 1.0))
    upper, lower = halves
    first = c.reversals_deg[0]
    instants = (
        (112.0, "flank"),
        (first + BEFORE, "before the first reversal"),
        (first + AT, "first reversal"),
        (first + TRAPPED, "trapped dimple"),
        (first + LEAVING, "dimple at the outlet"),
        (180.0, "nose"),
    )
    axes = upper.subplots(2, 3, sharex=True, sharey=True)
    for ax, (angle, words) in zip(axes.flat, instants, strict=True):
        _profile(ax, c, angle, words)
    for ax in axes[1]:
        ax.set_xlabel("x [µm]")
    maps = lower.subplots(1, 2, sharey=True)
    _map(lower, maps[0], c, GIGA * c.history.pressure, "Pressure [GPa]", PRESSURES, "magma")
    _map(lower, maps[1], c, MICRO * c.history.film, "Film [µm]", FILMS, "viridis")
    maps[0].set_ylabel("x [µm]")
    return figure


def _profile(ax: Axes, c: CamCycle, angle_deg: float, words: str) -> None:
    k = int(np.argmin(np.abs(c.history_deg - angle_deg)))
    history, x = c.history, MICRO * c.history.x[k]
    ax.fill_between(x, GIGA * history.pressure[k], color=REFERENCE, alpha=0.25, lw=0.0)
    ax.plot(x, GIGA * history.pressure[k], color=REFERENCE)
    ax.set_title(f"{angle_deg:.0f}°: {words}", loc="left", fontsize=9)
    other = ax.twinx()
    other.plot(x, MICRO * history.film[k], color=COUPLED)
    ax.set_xlim(-PROFILE, PROFILE)
    ax.set_ylim(0.0, 0.8)
    other.set_ylim(0.0, 1.6)
    other.grid(visible=False)
    ax.set_ylabel("Pressure [GPa]", color=REFERENCE)
    other.set_ylabel("Film [µm]", color=COUPLED)


def _map(
    figure: Any, ax: Axes, c: CamCycle, values: Vector, words: str, steps: Sequence[float], colours: str
) -> None:
    x = np.linspace(-WIDTH, WIDTH, ROWS)
    shown = np.flatnonzero((c.history_deg >= MAP_DEG[0]) & (c.history_deg <= MAP_DEG[1]))[::EVERY]
    rows = np.array([np.interp(x, MICRO * c.history.x[k], values[k]) for k in shown]).T
    # Steps of their own colour: few colours, and evenly spread over uneven steps.
    extend: Literal["both", "max"] = "both" if steps[0] > 0.0 else "max"
    norm = BoundaryNorm(steps, colormaps[colours].N, extend=extend)
    drawn = ax.contourf(c.history_deg[shown], x, rows, steps, cmap=colours, norm=norm, extend=extend)
    for angle in c.reversals_deg:
        ax.axvline(angle, color="white", lw=0.8, ls=(0, (3, 2)))
    ax.grid(visible=False)
    ax.set_title(words, loc="left", fontsize=9)
    ax.set_xlabel("Cam angle [deg] (nose at 180; dashed: reversals)")
    figure.colorbar(drawn, ax=ax, pad=0.02, ticks=steps, format="%g")
