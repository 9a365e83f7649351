"""Constraint force over crank angle."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.motions.machine import Machine
from models.slider_crank.motions.regions import holding_intervals, region, sign_changes, wall_forces

from ..errors import MistakeError
from ..plots.motion import add_legend, create_figure, set_angle_axis
from ..plots.style import ACCENT, COUPLED, MUTED
from ._machine import MECHANISM, build_machine, column
from .protocol import Parameter, Result, declare

TURN = 2.0 * math.pi


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
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


ANALYSIS = declare(
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
    table=build_table,
    draw=plot_force,
)
