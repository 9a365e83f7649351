"""Wear along the walls."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray

from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.motions.statistics import (
    effective_bins,
    energies,
    energy_profile,
    sampling_bias,
    uniformity,
)

from ._impacts import COUNTS, count_impacts, declare_impacts, simulate_impacts, tabulate_bins
from ._machine import build_machine
from ._table import column, draw_by, evaluate_by
from .protocol import Analysis, Result

# The number of bins is also taken smaller and larger, to show what depends on it.
FACTORS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
WALLS = {"upper": UPPER, "lower": LOWER}


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    """Energies per cycle along the walls, and the worn share over the number of bins."""
    machine, impacts, cycles = build_machine(values), simulate_impacts(values), values["cycles"]
    taken = energies(machine, impacts)
    numbers = sorted({max(2, round(factor * values["bins"])) for factor in FACTORS})
    found = {n: energy_profile(machine, impacts, n, cycles) for n in numbers}
    own = found[values["bins"]]
    worn = tabulate_bins(own, "1", "place on the wall x / l", "energy taken per cycle over M l^2 Omega^2")
    worn = worn.assign_coords(bins=column("bins", numbers, "1", "number of bins"))
    for wall, side in WALLS.items():
        share = [effective_bins(getattr(found[n], wall)) / n for n in numbers]
        weights = getattr(own, wall)
        worn[f"{wall}_worn_share"] = column("bins", share, "1", "effective bins over all bins")
        worn[f"{wall}_uniformity"] = uniformity(weights)
        worn[f"{wall}_bias"] = sampling_bias(weights, taken[impacts.side == side])
        worn[f"{wall}_spots"] = effective_bins(weights)
        worn[f"{wall}_energy"] = weights.sum()
    return worn.assign(count_impacts(impacts, values["cycles"]))


def _results(wall: str) -> dict[str, Result]:
    return {
        f"{wall}_energy": Result("1", f"energy taken by the {wall} wall per cycle over M l^2 Omega^2"),
        f"{wall}_uniformity": Result(
            "1", "entropy of its distribution over ln(bins): 1 even, 0 one spot, nan no impacts"
        ),
        f"{wall}_bias": Result("1", "by how much that is too small for so many impacts"),
        f"{wall}_spots": Result("1", "exp(entropy): so many bins alike would have it"),
    }


ANALYSIS = Analysis(
    name="wear",
    description="Wear: energy that impacts take along the walls, and how evenly",
    parameters=declare_impacts(3000, 100),
    results={**_results("upper"), **_results("lower"), **COUNTS},
    evaluate=evaluate_by(build_table),
    table=build_table,
    draw=draw_by("motion.wear", "plot_wear"),
)
