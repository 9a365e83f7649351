"""Regions of sliding over friction and clearance."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import xarray

from models.slider_crank.motions.regions import region, thresholds

from ..plots.motion.regions import plot_regions
from ._machine import MECHANISM, build_machine
from ._table import column, evaluate_by
from .protocol import Analysis, Parameter, Result


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    """Both thresholds over the clearance, from none to `largest_gap`."""
    machine = build_machine(values)
    build_machine({**values, "gap": values["largest_gap"]})
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
    evaluate=evaluate_by(build_table),
    table=build_table,
    draw=plot_regions,
)
