"""Figures and their numbers: films through the cam cycle, formulas over Table 3, the new power laws."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")  # no window, no display

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from models.quantities import Vector

from ...plots.style import ACCENT, COUPLED, MUTED, REFERENCE, headed
from ..pictures import compact
from .cam import CamCycle
from .formulas import CENTRAL, FORMULAS, MINIMUM, Formula
from .numerical import heights
from .runs import Runs

CYCLE, TABLE_3, LAWS = "films-cycle", "films-table-3", "films-power-laws"
FILES = (f"{CYCLE}.png", f"{TABLE_3}.png", f"{LAWS}.png", f"{CYCLE}.csv", f"{TABLE_3}.csv")
CAPTIONS = {
    CYCLE: "Steady numerical films through the cam's event, and formulas over them, dotted where their "
    "conditions do not hold",
    TABLE_3: "Formulas over the numerical central film, at contacts sampled over Kushwaha's Table 3",
    LAWS: "The new power laws over the numerical films of contacts that they were not fitted to",
}
INK = "#22282f"
COLOURS = {
    "kushwaha": REFERENCE,
    "kushwaha_negative": "#e8a0aa",
    "dowson_toyoda": ACCENT,
    "pan_hamrock_central": COUPLED,
    "dowson_higginson": ACCENT,
    "pan_hamrock_minimum": COUPLED,
    "moes_venner": "#c77d11",
}
# Of the figure with many panels.
DPI = 160.0
MICRO = 1e6


def draw(runs: Runs, folder: Path) -> list[Path]:
    """Every figure, and the numbers of those that have many."""
    return [
        compact(lambda: cycle(runs), folder / f"{CYCLE}.png", DPI),
        compact(lambda: table_3(runs), folder / f"{TABLE_3}.png"),
        compact(lambda: power_laws(runs), folder / f"{LAWS}.png"),
        _write(folder / f"{CYCLE}.csv", _cycle_rows(runs)),
        _write(folder / f"{TABLE_3}.csv", _sample_rows(runs)),
    ]


def cycle(runs: Runs) -> Figure:
    """A row for each speed: films, and formulas over the numerical central and minimum film."""
    rows = len(runs.cycles)
    figure, axes = plt.subplots(rows, 3, sharex=True, squeeze=False, figsize=(11.0, 1.2 + 1.8 * rows))
    headed(figure, "Steady films through the cam's event, and formulas over the numerical solution")
    for row, found in zip(axes, runs.cycles, strict=True):
        _films(row[0], found)
        for ax, film in zip(row[1:], (CENTRAL, MINIMUM), strict=True):
            _ratios(ax, found, film)
        row[0].set_ylabel(f"{found.speed_rpm:.0f} r/min\nFilm [µm]")
    titles = ("numerical film", "formula / numerical, central film", "formula / numerical, minimum film")
    for ax, title in zip(axes[0], titles, strict=True):
        ax.set_title(title, loc="left", fontsize=9)
    for ax in axes[0]:
        ax.legend(fontsize=6.8, handlelength=1.4, ncols=2, columnspacing=0.8, loc="upper center")
    for ax in axes[-1]:
        ax.set_xlabel("Cam angle [deg] (nose at 180)")
        ax.xaxis.set_major_locator(MultipleLocator(30.0))
        ax.set_xlim(90.0, 270.0)
    return figure


def _broken(found: CamCycle, values: Vector) -> tuple[Vector, Vector]:
    """Angles and values with gaps where entrainment reverses."""
    turns = np.flatnonzero(np.diff(np.sign(found.velocity))) + 1
    between = 0.5 * (found.angle_deg[turns] + found.angle_deg[turns - 1])
    return np.insert(found.angle_deg, turns, between), np.insert(values, turns, np.nan)


def _films(ax: Axes, found: CamCycle) -> None:
    ax.plot(*_broken(found, MICRO * found.central), color=INK, label=CENTRAL)
    ax.plot(*_broken(found, MICRO * found.minimum), color=MUTED, label=MINIMUM)
    ax.set_ylim(0.0, 1.3 * MICRO * np.nanmax(found.central))


def _ratios(ax: Axes, found: CamCycle, film: str) -> None:
    for formula in FORMULAS:
        if formula.film != film:
            continue
        ratio, colour = found.ratio(formula), COLOURS[formula.name]
        ax.plot(*_broken(found, ratio), color=colour, lw=0.9, ls=(0, (1, 1.6)))
        inside = np.where(found.valid[formula.name], ratio, np.nan)
        ax.plot(*_broken(found, inside), color=colour, lw=1.6, label=formula.words)
    ax.axhline(1.0, color=INK, lw=0.8, zorder=0.5)
    if film == CENTRAL:
        ax.set_yscale("log")
        ax.set_ylim(0.8, 14.0)
        ax.set_yticks([1.0, 1.5, 2.0, 5.0, 10.0])
        ax.yaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
        ax.yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    else:
        ax.set_ylim(0.85, 1.2)


def table_3(runs: Runs) -> Figure:
    """Ratio to the numerical central film over M: steady, and with squeeze for Kushwaha's formula."""
    figure, axes = plt.subplots(1, 2, sharey=True, figsize=(8.6, 3.4))
    headed(figure, "Formulas over the numerical central film, contacts of Kushwaha's Table 3")
    central = [formula for formula in FORMULAS if formula.film == CENTRAL]
    for formula in central:
        _points(axes[0], runs.fit.M, runs.fit.over_numerical(formula), formula)
    for formula in central[:2]:
        _points(axes[1], runs.fit.M, runs.fit.squeezed_over_numerical(formula), formula)
    for ax, words in zip(axes, ("steady", "with squeeze, −0.005 < w_s < 0"), strict=True):
        ax.axhline(1.0, color=INK, lw=0.9)
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_xlabel("M")
        ax.set_title(words, loc="left", fontsize=9)
        ax.yaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
        ax.yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
        ax.set_yticks([0.5, 1.0, 2.0, 5.0, 10.0])
    axes[0].set_ylabel("Formula / numerical")
    axes[0].legend(fontsize=7.5, markerscale=1.8)
    return figure


def _points(ax: Axes, x: Vector, y: Vector, formula: Formula) -> None:
    ax.plot(x, y, ".", ms=3.2, color=COLOURS[formula.name], label=formula.words)


def power_laws(runs: Runs) -> Figure:
    """New laws over numerical films against M, steady."""
    figure, axes = plt.subplots(1, 2, sharey=True, figsize=(8.6, 3.2))
    headed(figure, "New laws over numerical films, contacts that they were not fitted to")
    s = runs.validation
    looks = ((False, MUTED, "power law"), (True, COUPLED, "joined with Martin's film"))
    for ax, film in zip(axes, (CENTRAL, MINIMUM), strict=True):
        found = heights(s.steady, f"H_{film}")
        for blended, colour, words in looks:
            ax.plot(s.M, runs.laws[film, blended].H(s, False) / found, ".", ms=4.0, color=colour, label=words)
        ax.axhline(1.0, color=INK, lw=0.9)
        ax.set_xscale("log")
        ax.set_xlabel("M")
        ax.set_title(f"{film} film", loc="left", fontsize=9)
    axes[0].set_ylabel("New law / numerical")
    axes[0].legend(fontsize=7.5)
    return figure


def _cycle_rows(runs: Runs) -> list[list[Any]]:
    names = [formula.name for formula in FORMULAS]
    rows: list[list[Any]] = [
        ["speed [r/min]", "angle [deg]", "velocity [m/s]", "M [1]", "L [1]", "central [m]", "minimum [m]",
         *(f"{name} [m]" for name in names), *(f"{name} valid" for name in names)]
    ]  # fmt: skip
    for c in runs.cycles:
        for k, angle in enumerate(c.angle_deg):
            found = (c.velocity, c.M, c.L, c.central, c.minimum, *(c.by_formula[name] for name in names))
            flags = [int(c.valid[name][k]) for name in names]
            rows.append([f"{c.speed_rpm:g}", f"{angle:g}", *(f"{v[k]:.6g}" for v in found), *flags])
    return rows


def _sample_rows(runs: Runs) -> list[list[Any]]:
    head = ["sample", *(f"{name} [1]" for name in ("G", "W", "U", "w_s", "M", "L"))]
    head += [f"H {film}{state} [1]" for state in ("", " squeezed") for film in (CENTRAL, MINIMUM)]
    rows: list[list[Any]] = [head]
    for words, s in (("fit", runs.fit), ("validation", runs.validation)):
        columns = [s.material, s.load, s.speed, s.squeeze, s.M, s.L]
        for films in (s.steady, s.squeezed):
            columns += [heights(films, "H_central"), heights(films, "H_minimum")]
        rows += [[words, *(f"{v:.6g}" for v in row)] for row in zip(*columns, strict=True)]
    return rows


def _write(path: Path, rows: list[list[Any]]) -> Path:
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows(rows)
    return path
