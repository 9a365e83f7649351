"""Period over two parameters."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from models.slider_crank.motions.maps import period_map

from ..plots.cells import LABELS, draw_kinds
from ..plots.motion import create_figure, drop_varied
from ._machine import (
    MACHINE,
    build_machine,
    column,
    declare_axis,
    evaluate_by,
    read_axis,
    read_coordinate,
    report_mistakes,
    show_progress,
)
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


# None, 1 to 8, 9 to 16, 17 to 100, longer. Periods n and 2n have shades of one colour.
BOUNDS = (-0.5, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.5, 16.5, 100.5, np.inf)
COLOURS = (
    "#20242a", "#0b5fa5", "#5aa2d8", "#d1495b", "#a8d0ee", "#2a9d5c", "#eb9aa5", "#7b5ea7", "#dcedf9",
    "#e9b44c", "#f3d9a0", "#f7f3ea",
)  # fmt: skip
NAMES = ("none", "1", "2", "3", "4", "5", "6", "7", "8", "9–16", "17–100", "> 100")


def plot_period_map(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has period (y, x), 0 where none was found, over x and y."""
    figure, axes = create_figure("Period", drop_varied(values, "x", "y"), width=6.4, height=4.6)
    place = np.searchsorted(BOUNDS[1:-1], data["period"].values)
    bar = draw_kinds(figure, axes, data["x"].values, data["y"].values, place, COLOURS, NAMES)
    bar.set_label(f"period (cycles; none: not within {values['cycles']})")
    axes.set_xlabel(LABELS[values["x"]])
    axes.set_ylabel(LABELS[values["y"]])
    return figure


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
    draw=plot_period_map,
)
