"""Spectral radius and estimated error over the macro step: a column a master, a line a signal."""

import math
from collections.abc import Mapping
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...masters import find_name
from ...plots.style import SIGNALS, create_subplots
from ...scenario.units import format_time
from .survey import AssessedMethod, Survey

STABLE = "#dfeadf"
# Of a method that another one has the signal of, the same master in another order: seen below its twin, too.
_OTHER_ORDER: Mapping[str, Any] = {"lw": 4.0, "alpha": 0.4, "zorder": 1.0}


def draw_figure(found: Survey) -> Figure:
    masters = list(
        dict.fromkeys(find_name(m.master) for m in sorted(found.methods, key=lambda m: m.master.implicit))
    )
    title = f"{found.scenario.name}: coupling against the macro step"
    size = (1.2 + 2.7 * len(masters), 5.7)
    figure, axes = create_subplots(2, len(masters), title, size, sharex=True, sharey="row", squeeze=False)
    for column, name in enumerate(masters):
        radius, error = axes[:, column]
        radius.set_title(name)
        drawn: set[str] = set()
        for method in found.methods:
            if find_name(method.master) == name:
                signal = method.master.extrapolation
                style = _OTHER_ORDER if signal in drawn else {}
                drawn.add(signal)
                _draw_radius(radius, method, style)
                _draw_error(error, found, method, style)
        for panel in (radius, error):
            panel.set_xscale("log")
            panel.axvline(found.scenario.macro_step, color="black", lw=0.8, ls=":")
        radius.axhspan(0.0, 1.0, color=STABLE, zorder=0)
        error.set_xlabel("Macro step (s)")
    radius, error = axes[:, 0]
    radius.set_ylim(0.8, 2.5)
    radius.set_ylabel("Spectral radius of a step")
    error.set_yscale("log")
    low, high = error.get_ylim()
    error.set_ylim(max(low, 1e-6), min(high, 1e3))
    error.set_ylabel("Estimated error over tolerance")
    for panel in axes[1]:
        panel.axhline(1.0, color="black", lw=0.8)
    figure.legend(handles=_list_legend(found), loc="outside lower center", ncols=5)
    return figure


def _list_legend(found: Survey) -> list[Artist]:
    """What colours, lines and marks mean; only of signals that were surveyed."""
    used = {method.master.extrapolation for method in found.methods}
    step = format_time(found.scenario.macro_step)
    names = [(find_name(method.master), method.master.extrapolation) for method in found.methods]
    other = Line2D([], [], color="0.3", label="the same signals, another order", **_OTHER_ORDER)
    limits = [
        Line2D([], [], color="0.3", marker="o", ms=4.5, ls="", label="limit of stability"),
        Line2D([], [], color="0.3", lw=0.8, ls="--", label="beyond the limit: unstable"),
    ]
    return [
        *(Line2D([], [], color=colour, label=f"signals: {n}") for n, colour in SIGNALS.items() if n in used),
        *([other] if len(set(names)) < len(names) else []),
        *(limits if any(math.isfinite(method.limit) for method in found.methods) else []),
        Patch(color=STABLE, label="stable: radius up to 1"),
        Line2D([], [], color="black", lw=0.8, ls=":", label=f"the scenario's step, {step}"),
        Line2D([], [], color="black", lw=0.8, label="allowed error"),
    ]


def _draw_radius(axes: Axes, method: AssessedMethod, style: Mapping[str, Any]) -> None:
    """Dashed beyond the limit, where only few steps were sampled."""
    signal = method.master.extrapolation
    colour = SIGNALS[signal]
    seen = [(at.step, at.radius) for at in method.samples if math.isfinite(at.radius)]
    limit = [(method.limit, 1.0)] if math.isfinite(method.limit) else []
    stable = [point for point in seen if point[0] <= method.limit] + limit
    beyond = limit + [point for point in seen if point[0] > method.limit]
    axes.plot(*zip(*stable, strict=True), color=colour, **style)
    if limit:
        axes.plot(*zip(*beyond, strict=True), color=colour, ls="--", **{"lw": 0.8, **style})
        axes.plot(*limit[0], "o", color=colour, **{**style, "ms": 8.0 if style else 4.5})


def _draw_error(axes: Axes, found: Survey, method: AssessedMethod, style: Mapping[str, Any]) -> None:
    allowed = found.scenario.tolerance
    points = [
        (step, max(e / allowed[n] for n, e in errors.items())) for step, errors in method.errors.items()
    ]
    points = [(step, excess) for step, excess in points if math.isfinite(excess) and excess > 0.0]
    colour = SIGNALS[method.master.extrapolation]
    axes.plot([p[0] for p in points], [p[1] for p in points], marker=".", ms=5, color=colour, **style)
    if math.isfinite(method.limit) and points:
        axes.plot([method.limit] * 2, [points[-1][1], 1e3], color=colour, ls="--", **{"lw": 0.8, **style})
