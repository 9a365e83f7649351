"""Basins of attraction."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray

from models.slider_crank.motions.basins import LEAST, find_basins

from ._axes import report_mistakes
from ._machine import MACHINE, build_machine
from ._progress import show_progress
from ._table import column, draw_by, evaluate_by
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
    draw=draw_by("maps.basins", "plot_basins"),
)
