"""Figures and their numbers: films through the cam cycle, formulas over Table 3, the new power laws."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, NullFormatter

from models.core.quantities import Vector
from orchestrator.plots.style import COUPLED, MUTED, add_title, create_subplots

from ..pictures import save_compact
from .cycle_figure import COLOURS, INK, plot_cycles
from .field_figure import plot_field
from .formulas import CENTRAL, FORMULAS, MINIMUM, Formula
from .numerical import list_heights
from .runs import Runs

CYCLE, FIELD, TABLE_3, LAWS = "films-cycle", "films-field", "films-table-3", "films-power-laws"
FILES = (f"{CYCLE}.png", f"{FIELD}.png", f"{TABLE_3}.png", f"{LAWS}.png", f"{CYCLE}.csv", f"{TABLE_3}.csv")
CAPTIONS = {
    CYCLE: "Transient and steady numerical films through the cam's event, and other films over the "
    "transient one; dotted, with a bar below, where their conditions do not hold",
    FIELD: "Pressure and film across the contact at instants of the event, and over cam angle and x",
    TABLE_3: "Formulas over the numerical central film, at contacts sampled over Kushwaha's Table 3",
    LAWS: "The new power laws over the numerical films of contacts that they were not fitted to",
}
# Of the figures with many panels.
DPI = 105.0


def draw(runs: Runs, folder: Path) -> list[Path]:
    """Every figure, and the numbers of those that have many."""
    return [
        save_compact(lambda: plot_cycles(runs.cycles), folder / f"{CYCLE}.png", DPI),
        save_compact(lambda: plot_field(runs.shown), folder / f"{FIELD}.png", DPI),
        save_compact(lambda: plot_table_3(runs), folder / f"{TABLE_3}.png"),
        save_compact(lambda: plot_power_laws(runs), folder / f"{LAWS}.png"),
        _write(folder / f"{CYCLE}.csv", _cycle_rows(runs)),
        _write(folder / f"{TABLE_3}.csv", _sample_rows(runs)),
    ]


def plot_table_3(runs: Runs) -> Figure:
    """Ratio to the numerical central film over M: steady, and with squeeze for Kushwaha's formula."""
    figure, axes = create_subplots(1, 2, sharey=True, figsize=(8.6, 3.4))
    add_title(figure, "Formulas over the numerical central film, contacts of Kushwaha's Table 3")
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
        ax.yaxis.set_major_formatter(FormatStrFormatter("%g"))
        ax.yaxis.set_minor_formatter(NullFormatter())
        ax.set_yticks([0.5, 1.0, 2.0, 5.0, 10.0])
    axes[0].set_ylabel("Formula / numerical")
    axes[0].legend(fontsize=7.5, markerscale=1.8)
    return figure


def _points(ax: Axes, x: Vector, y: Vector, formula: Formula) -> None:
    ax.plot(x, y, ".", ms=3.2, color=COLOURS[formula.name], label=formula.words)


def plot_power_laws(runs: Runs) -> Figure:
    """New laws over numerical films against M, steady."""
    figure, axes = create_subplots(1, 2, sharey=True, figsize=(8.6, 3.2))
    add_title(figure, "New laws over numerical films, contacts that they were not fitted to")
    s = runs.validation
    looks = ((False, MUTED, "power law"), (True, COUPLED, "joined with Martin's film"))
    for ax, film in zip(axes, (CENTRAL, MINIMUM), strict=True):
        found = list_heights(s.steady, f"H_{film}")
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
    names = list(runs.cycles[0].judged)
    rows: list[list[Any]] = [
        ["speed [r/min]", "angle [deg]", "velocity [m/s]", "M [1]", "L [1]", "transient central [m]",
         "transient minimum [m]", *(f"{name} [m]" for name in names), *(f"{name} valid" for name in names)]
    ]  # fmt: skip
    for c in runs.cycles:
        films = (*c.transient.values(), *(judged.values for judged in c.judged.values()))
        for k, angle in enumerate(c.angle_deg):
            numbers = (f"{v[k]:.6g}" for v in (c.velocity, c.M, c.L, *films))
            flags = (int(judged.valid[k]) for judged in c.judged.values())
            rows.append([f"{c.speed_rpm:g}", f"{angle:g}", *numbers, *flags])
    return rows


def _sample_rows(runs: Runs) -> list[list[Any]]:
    head = ["sample", *(f"{name} [1]" for name in ("G", "W", "U", "w_s", "M", "L"))]
    head += [f"H {film}{state} [1]" for state in ("", " squeezed") for film in (CENTRAL, MINIMUM)]
    rows: list[list[Any]] = [head]
    for words, s in (("fit", runs.fit), ("validation", runs.validation)):
        columns = [s.material, s.load, s.speed, s.squeeze, s.M, s.L]
        for films in (s.steady, s.squeezed):
            columns += [list_heights(films, "H_central"), list_heights(films, "H_minimum")]
        rows += [[words, *(f"{v:.6g}" for v in row)] for row in zip(*columns, strict=True)]
    return rows


def _write(path: Path, rows: list[list[Any]]) -> Path:
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows(rows)
    return path
