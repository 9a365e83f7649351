"""Period over two parameters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray

from models.slider_crank.motions.maps import period_map

from ._axes import declare_axis, read_axis, read_coordinate, report_mistakes
from ._machine import MACHINE, build_machine
from ._progress import show_progress
from ._table import column, draw_by, evaluate_by
from .protocol import Analysis, Parameter, Result


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    machine, x, y = build_machine(values), read_axis(values, "x"), read_axis(values, "y")
    with report_mistakes(), show_progress("period map") as shown:
        found = period_map(machine, x, y, values["cycles"], progress=shown)
    return xarray.Dataset(
        {
            "period": column(("y", "x"), found, "1", "cycles after which the motion repeats, 0: none found"),
            "periodic_share": float(np.mean(found > 0)),
            "simple_share": float(np.mean(found == 1)),
            "longest": float(found.max()),
        },
        coords={"x": read_coordinate(values, "x"), "y": read_coordinate(values, "y")},
    )


ANALYSIS = Analysis(
    name="period_map",
    description="Period of the motion over two parameters, every point from rest in the middle",
    parameters={
        **MACHINE,
        **declare_axis("x", "damping", 0.01, 0.25, 60),
        **declare_axis("y", "gap", 0.005, 0.02, 60),
        "cycles": Parameter(2000, "1", "crank cycles within which a period is looked for", 1.0, integer=True),
    },
    results={
        "periodic_share": Result("1", "part of the points with a period"),
        "simple_share": Result("1", "part of the points that repeat every cycle"),
        "longest": Result("1", "longest period found, in cycles"),
    },
    evaluate=evaluate_by(build_table),
    table=build_table,
    draw=draw_by("maps.periods", "plot_period_map"),
)
