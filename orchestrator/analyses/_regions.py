"""What holds a resting slider at each wall: force over crank angle, regions over friction and clearance."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.core.quantities import Vector
from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.motions.machine import Machine
from models.slider_crank.motions.regions import (
    holding_intervals,
    region,
    sign_changes,
    thresholds,
    wall_forces,
)

from ..errors import MistakeError
from ..plots.motion import add_legend, create_figure, set_angle_axis
from ..plots.style import ACCENT, COUPLED, MUTED, REFERENCE
from ._machine import MECHANISM, build_machine, column
from .protocol import Parameter, Result, declare

TURN = 2.0 * math.pi


def tabulate_force(values: Mapping[str, Any]) -> xarray.Dataset:
    """Forces over the window, and where they can hold."""
    if values["end"] <= values["start"]:
        raise MistakeError(
            f"end = {values['end']:g} rad: must be greater than start = {values['start']:g} rad"
        )
    machine = build_machine(values)
    theta = np.linspace(values["start"], values["end"], values["points"])
    return xarray.Dataset(
        {
            "upper": column("theta", wall_forces(machine, UPPER, theta), "1", "f_u: force over M l Omega^2"),
            "lower": column("theta", wall_forces(machine, LOWER, theta), "1", "f_l: force over M l Omega^2"),
            "region": region(machine),
            "upper_sign_changes": sign_changes(machine, UPPER),
            "lower_sign_changes": sign_changes(machine, LOWER),
            "upper_share": _compute_share(machine, UPPER),
            "lower_share": _compute_share(machine, LOWER),
        },
        coords={"theta": column("theta", theta, "rad", "crank angle")},
    )


def _compute_share(machine: Machine, side: float) -> float:
    return sum(interval.end - interval.start for interval in holding_intervals(machine, side)) / TURN


def plot_force(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """f_u and f_l, filled where the wall can hold the slider."""
    figure, axes = create_figure("Constraint forces", values, width=6.8, height=3.0)
    angle = data["theta"].values
    axes.axhline(0.0, color=MUTED, lw=0.8)
    for wall, colour in (("upper", COUPLED), ("lower", ACCENT)):
        force = data[wall].values
        axes.fill_between(angle, 0.0, np.maximum(force, 0.0), color=colour, alpha=0.15, lw=0.0)
        axes.plot(angle, force, color=colour, lw=1.3, label=f"{wall} wall")
    set_angle_axis(axes, values["start"], values["end"])
    axes.set_ylabel("force f / (M l Ω²)")
    add_legend(figure, axes)
    return figure


FORCE = declare(
    name="force",
    description="Constraint force: what holds a resting slider at each wall, over crank angle (F 2.6)",
    parameters={
        **MECHANISM,
        "start": Parameter(0.0, "rad", "first crank angle"),
        "end": Parameter(TURN, "rad", "last crank angle"),
        "points": Parameter(1441, "1", "crank angles", minimum=2.0, integer=True),
    },
    results={
        "region": Result("1", "F's region of sliding: I, II, III", text=True),
        "upper_sign_changes": Result("1", "changes of sign of f_u a cycle"),
        "lower_sign_changes": Result("1", "changes of sign of f_l a cycle"),
        "upper_share": Result("1", "part of the cycle in which the upper wall can hold the slider"),
        "lower_share": Result("1", "part of the cycle in which the lower wall can hold the slider"),
    },
    table=tabulate_force,
    draw=plot_force,
)


def tabulate_regions(values: Mapping[str, Any]) -> xarray.Dataset:
    """Both thresholds over the clearance, from none to `largest_gap`."""
    machine = build_machine(values)
    build_machine({**values, "gap": values["largest_gap"]})
    gaps = np.linspace(0.0, values["largest_gap"], values["points"])
    found = [thresholds(replace(machine, gap=float(gap))) for gap in gaps]
    own = thresholds(machine)
    return xarray.Dataset(
        {
            "upper": column("gap", [one.upper for one in found], "1", "lambda: upper wall holds throughout"),
            "lower": column("gap", [one.lower for one in found], "1", "lambda: lower wall holds nowhere"),
            "region": region(machine),
            "upper_threshold": own.upper,
            "lower_threshold": own.lower,
            "limit": found[0].upper,
        },
        coords={"gap": column("gap", gaps, "1", "clearance over rod length, rho")},
    )


INK = "#3a444e"


def _draw_name(axes: Axes, x: float, y: float, name: str, words: str) -> None:
    axes.annotate(name, (x, y), ha="center", va="bottom", fontsize=13, fontweight="bold", color=INK)
    axes.annotate(
        words, (x, y), (0.0, -3.0), textcoords="offset points", ha="center", va="top", fontsize=7.5, color=INK
    )


def _draw_name_between(axes: Axes, gap: Vector, upper: Vector, lower: Vector, span: float) -> None:
    """The name of region II in it, or beside it where it is narrow; that of none of F's where it is in II's
    place."""
    y = 0.85 * gap[-1]
    first, second = np.interp(y, gap, upper), np.interp(y, gap, lower)
    name, words = "II", "upper throughout,\nlower in a part"
    if second < first:
        name, words = "none", "upper in a part,\nlower nowhere"
    middle = 0.5 * (first + second)
    if abs(second - first) > 0.2 * span:
        _draw_name(axes, middle, y, name, words)
        return
    axes.annotate(
        name, (middle, y), (30.0, 0.0), textcoords="offset points", va="center", fontsize=13,
        fontweight="bold", color=INK, arrowprops={"arrowstyle": "-", "color": INK, "lw": 0.8},
    )  # fmt: skip


def plot_regions(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    shown = {name: value for name, value in values.items() if name not in ("damping", "gap")}
    figure, axes = create_figure("Regions of sliding", shown, width=5.6, height=3.8)
    gap, upper, lower = (data[name].values for name in ("gap", "upper", "lower"))
    low, high = 0.0, 1.4 * max(upper.max(), lower.max(), values["damping"])
    first, last = np.minimum(upper, lower), np.maximum(upper, lower)
    axes.fill_betweenx(gap, low, first, color=ACCENT, alpha=0.13, lw=0.0)
    axes.fill_betweenx(gap, first, last, where=lower > upper, color=REFERENCE, alpha=0.22, lw=0.0)
    axes.fill_betweenx(gap, first, last, where=lower < upper, color=MUTED, alpha=0.22, lw=0.0)
    axes.fill_betweenx(gap, last, high, color=COUPLED, alpha=0.13, lw=0.0)
    axes.plot(upper, gap, color=COUPLED, lw=1.4)
    axes.plot(lower, gap, color=ACCENT, lw=1.4)
    axes.set_xlim(low, high)
    axes.set_ylim(gap[0], gap[-1])
    axes.set_xlabel("friction λ")
    axes.set_ylabel("clearance ρ")
    middle = 0.6 * gap[-1]
    left, right = np.interp(middle, gap, first), np.interp(middle, gap, last)
    _draw_name(axes, 0.5 * (low + left), middle, "I", "each wall holds\nin a part of the cycle")
    _draw_name(axes, 0.5 * (right + high), middle, "III", "upper wall throughout,\nlower wall nowhere")
    _draw_name_between(axes, gap, upper, lower, high - low)
    axes.plot(values["damping"], values["gap"], "o", color="#3a444e", ms=4.5)
    axes.annotate(
        "this machine", (values["damping"], values["gap"]), (6, -3), textcoords="offset points", fontsize=7.5
    )
    return figure


REGIONS = declare(
    name="regions",
    description="Regions I-III of sliding over friction and clearance (F 2.10)",
    parameters={
        **MECHANISM,
        "largest_gap": Parameter(0.04, "1", "largest clearance over rod length", positive=True),
        "points": Parameter(81, "1", "clearances", minimum=2.0, integer=True),
    },
    results={
        "region": Result(
            "1", "I: both walls hold in parts of the cycle, II: upper throughout, III: only it", True
        ),
        "upper_threshold": Result("1", "lambda from which on the upper wall holds throughout"),
        "lower_threshold": Result("1", "lambda from which on the lower wall holds nowhere"),
        "limit": Result("1", "both for vanishing clearance: threshold of permanent sliding"),
    },
    table=tabulate_regions,
    draw=plot_regions,
)
