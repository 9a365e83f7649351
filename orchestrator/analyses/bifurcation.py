"""Bifurcation diagram over any parameter."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MultipleLocator

from models.slider_crank.motions.bifurcation import RECORDS, continue_sweep, sweep_from_rest

from ..plots.motion import LABELS, add_legend, create_figure, drop_varied, format_angle
from ..plots.style import COUPLED, REFERENCE
from ._machine import (
    MACHINE,
    build_machine,
    column,
    declare_axis,
    declare_duration,
    read_axis,
    report_mistakes,
    show_points,
)
from .protocol import Parameter, Result, declare

STARTS = ("followed", "from_rest")
UNITS = {"impact_rate": "1", "impact_angle": "rad", "strobe_psi": "rad"}
UP, DOWN, REST = 1, -1, 0


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    machine, (name, x) = build_machine(values), read_axis(values, "x")
    varied = MACHINE[name].quantity
    how = (values["record"], values["cycles"], values["transient"])
    with report_mistakes():
        if values["start"] == "from_rest":
            diagrams = {REST: sweep_from_rest(machine, name, x, *how, progress=show_points)}
        else:
            diagrams = {
                UP: continue_sweep(machine, name, x, *how, progress=show_points),
                DOWN: continue_sweep(machine, name, x[::-1], *how, progress=show_points),
            }
    value, recorded = (np.concatenate(parts) for parts in zip(*diagrams.values(), strict=True))
    direction = np.repeat(list(diagrams), [len(diagram.value) for diagram in diagrams.values()])
    return xarray.Dataset(
        {
            "recorded": column("point", recorded, UNITS[values["record"]], values["record"]),
            "direction": column(
                "point", direction, "1", "1: values followed upwards, -1: downwards, 0: from rest"
            ),
            "points": float(len(recorded)),
        },
        coords={"value": column("point", value, varied.unit, varied.description)},
    )


RECORDED = {
    "impact_rate": "ψ′ before upper-wall impacts",
    "impact_angle": "crank angle of upper-wall impacts θ (rad)",
    "strobe_psi": "ψ at crank angle 0 (mrad)",
}
# Direction, its colour and its name; the later one lies above.
DIRECTIONS = ((-1, REFERENCE, "downwards"), (1, COUPLED, "upwards"), (0, COUPLED, None))


def plot_bifurcation(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has value, recorded and direction of every point."""
    figure, axes = create_figure("Bifurcation diagram", drop_varied(values, "x"), width=6.8, height=4.2)
    record = values["record"]
    value, direction = data["value"].values, data["direction"].values
    recorded = data["recorded"].values * (1e3 if record == "strobe_psi" else 1.0)
    # The places' distance in points of the page, and a little less; where points coincide they add up.
    size = min(2.0, max(0.4, 300.0 / len(np.unique(value)))) ** 2 if len(value) else 1.0
    for which, colour, name in DIRECTIONS:
        chosen = direction == which
        if chosen.any():
            axes.scatter(
                value[chosen], recorded[chosen], s=size, color=colour, lw=0, alpha=0.2, rasterized=True
            )
            axes.plot([], [], ls="", marker="o", ms=4, color=colour, label=name)
    axes.margins(x=0.01)
    axes.set_xlabel(LABELS[values["x"]])
    axes.set_ylabel(RECORDED[record])
    if record == "impact_angle":
        axes.set_ylim(0.0, 2.0 * np.pi)
        axes.yaxis.set_major_locator(MultipleLocator(np.pi / 2.0))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda angle, _: format_angle(angle)))
    add_legend(figure, axes)
    return figure


ANALYSIS = declare(
    name="bifurcation",
    description="Bifurcation diagram over any parameter",
    parameters={
        **MACHINE,
        **declare_axis("x", "damping", 0.01, 0.25, 400),
        "record": Parameter(
            "impact_rate",
            "1",
            "upper-wall impacts: psi' before or angle; psi at angle 0",
            choices=tuple(RECORDS),
        ),
        "start": Parameter("followed", "1", "from the state before, both ways, or from rest", choices=STARTS),
        **declare_duration(50, 200),
    },
    results={"points": Result("1", "points of the diagram")},
    table=build_table,
    draw=plot_bifurcation,
)
