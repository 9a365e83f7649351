"""Period over two parameters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from models.slider_crank.motions.maps import period_map

from ._axes import along, axis, coordinate, fixed, mistakes
from ._machine import MACHINE, machine_of
from ._progress import progress
from ._table import column, scalars
from .protocol import Analysis, Parameter, Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def table(values: Mapping[str, Any]) -> xarray.Dataset:
    machine, x, y = machine_of(values), along(values, "x"), along(values, "y")
    with mistakes(), progress("period map") as shown:
        found = period_map(machine, x, y, values["cycles"], progress=shown)
    return xarray.Dataset(
        {
            "period": column(("y", "x"), found, "1", "cycles after which the motion repeats, 0: none found"),
            "periodic_share": float(np.mean(found > 0)),
            "simple_share": float(np.mean(found == 1)),
            "longest": float(found.max()),
        },
        coords={"x": coordinate(values, "x"), "y": coordinate(values, "y")},
    )


def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
    return scalars(table(values))


def draw(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    from ..plots.maps.periods import draw_periods
    from ..plots.motion.titles import titled

    figure, axes = titled("Period", fixed(values, "x", "y"), width=6.4, height=4.6)
    draw_periods(figure, axes, data, values["x"], values["y"], values["cycles"])
    return figure


ANALYSIS = Analysis(
    name="period_map",
    description="Period of the motion over two parameters, every point from rest in the middle",
    parameters={
        **MACHINE,
        **axis("x", "damping", 0.01, 0.25, 60),
        **axis("y", "gap", 0.005, 0.02, 60),
        "cycles": Parameter(2000, "1", "crank cycles within which a period is looked for", 1.0, integer=True),
    },
    results={
        "periodic_share": Result("1", "part of the points with a period"),
        "simple_share": Result("1", "part of the points that repeat every cycle"),
        "longest": Result("1", "longest period found, in cycles"),
    },
    evaluate=evaluate,
    table=table,
    draw=draw,
)
