"""Error over doStep calls and over wall time: a line for each method, other tools dashed in grey."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...plots.style import REFERENCE, SIGNALS, add_title, create_subplots
from .problem import CouplingProblem
from .row import Row

MASTERS = {"jacobi": ("o", ":"), "gauss_seidel": ("s", "--"), "iterated": ("^", "-")}
OTHERS = (("x", "#20242a"), ("+", "#7b5ea7"), ("1", "#c77d0a"), ("2", "#5b4636"))
# Errors from 1 up are no solution any more; shown up to HOPELESS.
HOPELESS = 30.0


def draw_figure(problem: CouplingProblem, rows: Sequence[Row]) -> Figure:
    figure, axes = create_subplots(1, 2, sharey=True, figsize=(9.4, 4.6))
    add_title(figure, f"{problem.name}: work and precision of co-simulation masters")
    for panel, quantity, label in zip(
        axes, ("calls", "wall_time_s"), ("doStep calls of all instances", "Wall time of the stepping (s)"),
        strict=True,
    ):  # fmt: skip
        _draw_lines(panel, rows, quantity)
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xlabel(label)
    axes[0].set_ylabel("Largest relative RMS error of the outputs")
    axes[0].set_ylim(top=min(HOPELESS, axes[0].get_ylim()[1]))
    if axes[0].get_ylim()[1] > 1.0:
        for panel in axes:
            panel.axhspan(1.0, HOPELESS, color="#f3f4f6", lw=0.0, zorder=0)
    if problem.uncertainty > 0.0:
        _draw_uncertainty(axes, problem.uncertainty)
    handles, labels = axes[1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", handlelength=2.6)
    return figure


def _draw_uncertainty(panels: Sequence[Axes], uncertainty: float) -> None:
    """Draw the error below which the reference is not known."""
    panels[0].set_ylim(bottom=0.5 * uncertainty)
    for panel in panels:
        panel.axhline(uncertainty, color=REFERENCE, lw=0.8, ls=(0, (1, 2)))
    panels[0].annotate(
        "uncertainty of the reference", (0.02, uncertainty), xycoords=("axes fraction", "data"),
        xytext=(0, 3), textcoords="offset points", fontsize=7.5, color=REFERENCE,
    )  # fmt: skip


def _draw_lines(axes: Axes, rows: Sequence[Row], quantity: str) -> None:
    peers = list(dict.fromkeys(row.tool for row in rows if row.tool == row.method))
    for method in dict.fromkeys(row.method for row in rows):
        shown = [row for row in rows if row.method == method and np.isfinite(row.error)]
        if not shown:
            continue
        x = [getattr(row, quantity) for row in shown]
        y = [row.error for row in shown]
        if method in peers:
            marker, color = OTHERS[peers.index(method) % len(OTHERS)]
            axes.plot(x, y, marker=marker, color=color, ls="-.", lw=0.9, ms=7.0, label=method)
        else:
            master, signal, *estimator = method.split(", ")
            marker, line = MASTERS.get(master, ("D", "-"))
            # With step control: open markers and a wide pale line.
            style: dict[str, Any] = {"mfc": "white", "lw": 2.4, "alpha": 0.7} if estimator else {}
            axes.plot(x, y, marker=marker, ms=4.0, ls=line, color=SIGNALS[signal], label=method, **style)
