"""Basins of attraction."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from models.slider_crank.motions.basins import LEAST, find_basins

from ..plots.cells import draw_kinds
from ..plots.motion import create_figure
from ._machine import MACHINE, build_machine, column, evaluate_by, report_mistakes, show_progress
from .protocol import Analysis, Parameter, Result


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    machine, count = build_machine(values), values["count"]
    psi = values["gap"] * np.linspace(-1.0, 1.0, count)
    rate = values["largest_rate"] * np.linspace(-1.0, 1.0, count)
    with report_mistakes(), show_progress("basins of attraction") as shown:
        found = find_basins(machine, psi, rate, values["cycles"], progress=shown)
    period, exponent, error, starts = zip(*found.attractors, strict=True)
    return xarray.Dataset(
        {
            "attractor": column(("psi_rate", "psi"), found.label, "1", "attractor on which it ends"),
            "period": column("number", list(period), "1", "period in cycles, 0: none found"),
            "exponent": column("number", list(exponent), "1/rad", "largest exponent, -inf: slides"),
            "uncertainty": column("number", list(error), "1/rad", "its standard error"),
            "starts": column("number", list(starts), "1", "starts that end on it"),
            "attractors": float(len(found.attractors)),
            "largest_share": starts[0] / count**2,
        },
        coords={
            "psi": column("psi", psi, "rad", "start, crank angle 0"),
            "psi_rate": column("psi_rate", rate, "1", "its derivative by crank angle"),
        },
    )


COLOURS = ("#0b5fa5", "#e9b44c", "#d1495b", "#2a9d5c", "#7b5ea7", "#5aa2d8", "#eb9aa5")
# All rarer attractors together.
REST = "#20242a"


def plot_basins(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has attractor (psi_rate, psi) over the starts, and period, exponent and starts (number)."""
    found = data.sizes["number"]
    title = f"Basins of {found} attractors" if found > 1 else "All starts end on one attractor"
    figure, axes = create_figure(title, values, width=6.8, height=4.6)
    count = min(found, len(COLOURS))
    place = np.minimum(data["attractor"].values, count)
    names = [_format_name(data, n) for n in range(count)]
    colours = list(COLOURS[:count])
    if found > count:
        starts = data["starts"].values
        names.append(f"{found - count} others\n{starts[count:].sum() / starts.sum():.1%}")
        colours.append(REST)
    draw_kinds(figure, axes, 1e3 * data["psi"].values, data["psi_rate"].values, place, colours, names)
    axes.set_xlabel("ψ at crank angle 0 (mrad)")
    axes.set_ylabel("ψ′ at crank angle 0")
    return figure


def _format_name(data: xarray.Dataset, n: int) -> str:
    """What an attractor is, and its share of the starts."""
    one = data.isel(number=n)
    period, exponent, error = (one[name].item() for name in ("period", "exponent", "uncertainty"))
    share = one["starts"].item() / data["starts"].values.sum()
    if period:
        words = f"period {period}, slides" if exponent == -math.inf else f"period {period}"
    else:
        words = "chaotic" if exponent > 3.0 * error else "no period found"
    return f"{words}\n{share:.1%}"


ANALYSIS = Analysis(
    name="basins",
    description="Basins of attraction: where starts between the walls end",
    parameters={
        **MACHINE,
        "count": Parameter(80, "1", "starts along psi and along psi'", minimum=2.0, integer=True),
        "largest_rate": Parameter(0.15, "1", "psi' of the starts: up to this, both ways", positive=True),
        "cycles": Parameter(4000, "1", "cycles that a motion is looked at for", minimum=LEAST, integer=True),
    },
    results={
        "attractors": Result("1", "attractors found"),
        "largest_share": Result("1", "part of the starts that end on the most common one"),
    },
    evaluate=evaluate_by(build_table),
    table=build_table,
    draw=plot_basins,
)
