"""Measured signals with the fitted model, and what it leaves."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.core.quantities import Vector

from ..scenario.display import Shown
from .style import COUPLED, MUTED, REFERENCE, create_subplots

# Speeds that are drawn.
MOST_COLUMNS = 4


class Panel(NamedTuple):
    """A signal at one speed (rad/s; None: a run): measured and model in `unit`, drawn as `shown`, over
    positions of `shaft` (rad or s)."""

    signal: str
    unit: str
    shown: Shown
    speed: float | None
    shaft: str
    positions: Vector
    data: Vector
    model: Vector


def draw_calibration(panels: Sequence[Panel], title: str) -> Figure:
    """A column for each speed; for each signal the curves, below them the residuals."""
    signals = list(dict.fromkeys(one.signal for one in panels))
    speeds = list(dict.fromkeys(one.speed for one in panels))
    if len(speeds) > MOST_COLUMNS:
        speeds = [speeds[i] for i in np.linspace(0, len(speeds) - 1, MOST_COLUMNS).round().astype(int)]
    rows = 2 * len(signals)
    shape: dict[str, Any] = {"sharex": "col", "sharey": "row", "height_ratios": [2.0, 1.0] * len(signals)}
    size = (2.0 + 3.0 * len(speeds), 0.8 + 1.6 * rows)
    figure, axes = create_subplots(rows, len(speeds), title, size, squeeze=False, **shape)
    for one in panels:
        if one.speed not in speeds:
            continue
        column, row = speeds.index(one.speed), 2 * signals.index(one.signal)
        shown, at = one.shown, _scale(one)
        above, below = axes[row, column], axes[row + 1, column]
        above.plot(at, shown.factor * one.data, ".", color=MUTED, markersize=2.5, label="measured")
        above.plot(at, shown.factor * one.model, color=COUPLED, label="model")
        below.plot(at, shown.factor * (one.data - one.model), color=REFERENCE, linewidth=0.7)
        if not column:
            above.set_ylabel(f"{one.signal}\n[{shown.symbol or '1'}]")
            below.set_ylabel(f"residual\n[{shown.symbol or '1'}]")
        if not row and one.speed is not None:
            above.set_title(f"{one.speed * 30.0 / math.pi:.0f} r/min")
        if row == rows - 2:
            words = {"time": "Time (s)", "cam_angle": "Cam angle (°)", "crank_angle": "Crank angle (°)"}
            below.set_xlabel(words[one.shaft])
    axes[0, 0].legend(loc="best")
    return figure


def _scale(one: Panel) -> Vector:
    return one.positions if one.shaft == "time" else np.degrees(one.positions)


def draw_parameters(names: Sequence[str], intervals: Vector, correlation: Vector, title: str) -> Figure:
    """95 % intervals (parameters, 2) over the values, nan where not identified, and correlations."""
    count = len(names)
    width, shape = (6.0, [1.0]) if count == 1 else (11.0, [1.0, 1.2])
    size = (width, 1.8 + 0.35 * count)
    figure, axes = create_subplots(1, len(shape), title, size, width_ratios=shape, squeeze=False)
    left = axes[0, 0]
    rows = np.arange(count)
    percent = 100.0 * (intervals - 1.0)
    left.hlines(rows, percent[:, 0], percent[:, 1], color=COUPLED, linewidth=3.0)
    left.plot(np.where(np.isfinite(percent[:, 0]), 0.0, np.nan), rows, "|", color=REFERENCE)
    for row in np.flatnonzero(~np.isfinite(percent).all(axis=1)):
        left.text(0.0, row, "not identified", ha="center", va="center", color=MUTED)
    left.set(yticks=rows, yticklabels=names, xlabel="95 % interval about the fitted value [%]")
    left.set_ylim(count - 0.5, -0.5)
    for right in axes[0, 1:]:
        _draw_correlation(figure, right, names, correlation)
    return figure


def _draw_correlation(figure: Figure, right: Axes, names: Sequence[str], correlation: Vector) -> None:
    rows = np.arange(len(names))
    image = right.imshow(correlation, cmap="RdBu_r", vmin=-1.0, vmax=1.0, aspect="auto")
    right.set(xticks=rows, yticks=rows, yticklabels=[])
    right.set_xticklabels([name.partition(".")[2] for name in names], rotation=40.0, ha="right")
    right.grid(visible=False)
    for (i, j), value in np.ndenumerate(correlation):
        shade = "white" if abs(value) > 0.6 else "black"
        right.text(j, i, f"{value:.2f}", ha="center", va="center", color=shade, fontsize=7)
    figure.colorbar(image, ax=right, label="correlation")
