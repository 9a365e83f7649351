"""Regions of sliding over friction and clearance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

from models.slider_crank.motions.regions import region, thresholds

from ._machine import MECHANISM, machine_of
from ._table import column, scalars
from .protocol import Analysis, Parameter, Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def table(values: Mapping[str, Any]) -> xarray.Dataset:
    """Both thresholds over the clearance, from none to `largest_gap`."""
    machine = machine_of(values)
    machine_of({**values, "gap": values["largest_gap"]})
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


def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
    return scalars(table(values))


def draw(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    from ..plots.motion.regions import draw_regions
    from ..plots.motion.titles import titled

    shown = {name: value for name, value in values.items() if name not in ("damping", "gap")}
    figure, axes = titled("Regions of sliding", shown, width=5.6, height=3.8)
    columns = [data[name].values for name in ("gap", "upper", "lower")]
    highest = 1.4 * max(columns[1].max(), columns[2].max(), values["damping"])
    draw_regions(axes, *columns, damping=(0.0, highest))
    axes.plot(values["damping"], values["gap"], "o", color="#3a444e", ms=4.5)
    axes.annotate(
        "this machine", (values["damping"], values["gap"]), (6, -3), textcoords="offset points", fontsize=7.5
    )
    return figure


ANALYSIS = Analysis(
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
    evaluate=evaluate,
    table=table,
    draw=draw,
)
