"""Largest Lyapunov exponent over two parameters."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from models.slider_crank.motions.maps import exponent_map

from ..plots.cells import LABELS, draw_cells
from ..plots.motion import create_figure, drop_varied
from ._machine import (
    MACHINE,
    build_machine,
    column,
    declare_axis,
    declare_duration,
    read_axis,
    read_coordinate,
    report_mistakes,
    show_points,
)
from .protocol import Result, declare


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    machine, x, y = build_machine(values), read_axis(values, "x"), read_axis(values, "y")
    length = values["cycles"], values["transient"]
    with report_mistakes():
        found = exponent_map(machine, x, y, *length, progress=show_points)
    return xarray.Dataset(
        {
            "largest": column(("y", "x"), found.largest, "1/rad", "largest exponent, -inf: slides"),
            "uncertainty": column(("y", "x"), found.uncertainty, "1/rad", "its standard error"),
            "impacts_per_cycle": column(("y", "x"), found.impacts_per_cycle, "1", "impacts per cycle"),
            "chaotic_share": float(np.mean(found.largest > 3.0 * found.uncertainty)),
            "sliding_share": float(np.mean(np.isneginf(found.largest))),
            "highest": float(found.largest.max()),
        },
        coords={"x": read_coordinate(values, "x"), "y": read_coordinate(values, "y")},
    )


SLIDING = "#b4bac1"


def plot_exponent_map(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has largest (y, x), -inf where the motion slides, over x and y."""
    title, shown = "Largest Lyapunov exponent", drop_varied(values, "x", "y")
    figure, axes = create_figure(title, shown, width=6.4, height=4.6)
    found = data["largest"].values
    finite = found[np.isfinite(found)]
    limit = float(np.abs(finite).max()) if finite.size else 1.0
    axes.set_facecolor(SLIDING)
    bar = draw_cells(
        figure, axes, data["x"].values, data["y"].values, np.ma.masked_invalid(found),
        cmap="RdBu_r", vmin=-limit, vmax=limit,
    )  # fmt: skip
    bar.set_label("largest Lyapunov exponent (1/rad)")
    bar.outline.set_visible(False)
    axes.set_xlabel(LABELS[values["x"]])
    axes.set_ylabel(LABELS[values["y"]])
    if finite.size < found.size:
        figure.legend(
            handles=[Patch(color=SLIDING, label="slides (−∞)")],
            loc="upper right",
            bbox_to_anchor=(0.995, 1.0),
        )
    return figure


ANALYSIS = declare(
    name="exponent_map",
    description="Largest Lyapunov exponent over two parameters, every point from rest in the middle",
    parameters={
        **MACHINE,
        **declare_axis("x", "damping", 0.01, 0.25, 60),
        **declare_axis("y", "gap", 0.005, 0.02, 60),
        **declare_duration(1000, 200),
    },
    results={
        "chaotic_share": Result("1", "part of the points with an exponent 3 standard errors above 0"),
        "sliding_share": Result("1", "part of the points whose motion slides"),
        "highest": Result("1/rad", "highest of the largest exponents"),
    },
    table=build_table,
    draw=plot_exponent_map,
)
