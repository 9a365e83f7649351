"""Bifurcation diagram over any parameter."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray

from models.slider_crank.motions.bifurcation import RECORDS, continue_sweep, sweep_from_rest

from ._axes import declare_axis, read_axis, report_mistakes
from ._machine import MACHINE, build_machine, declare_duration
from ._progress import show_progress
from ._table import column, draw_by, evaluate_by
from .protocol import Analysis, Parameter, Result

STARTS = ("followed", "from_rest")
UNITS = {"impact_rate": "1", "impact_angle": "rad", "strobe_psi": "rad"}
UP, DOWN, REST = 1, -1, 0


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    machine, (name, x) = build_machine(values), read_axis(values, "x")
    how = (values["record"], values["cycles"], values["transient"])
    with report_mistakes(), show_progress("bifurcation diagram") as shown:
        if values["start"] == "from_rest":
            diagrams = {REST: sweep_from_rest(machine, name, x, *how, progress=shown)}
        else:
            diagrams = {
                UP: continue_sweep(machine, name, x, *how, progress=shown),
                DOWN: continue_sweep(machine, name, x[::-1], *how, progress=shown),
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
        coords={"value": column("point", value, MACHINE[name].unit, MACHINE[name].description)},
    )


ANALYSIS = Analysis(
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
    evaluate=evaluate_by(build_table),
    table=build_table,
    draw=draw_by("maps.bifurcation", "plot_bifurcation"),
)
