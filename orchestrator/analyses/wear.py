"""Wear along the walls."""

from collections.abc import Mapping
from typing import Any

import xarray
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, ScalarFormatter

from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.motions.statistics import (
    effective_bins,
    energies,
    energy_profile,
    sampling_bias,
    uniformity,
)

from ..plots.motion import add_legend, create_figure
from ..plots.style import ACCENT, COUPLED, MUTED
from ._distribution import (
    COUNTS,
    count_impacts,
    declare_impacts,
    draw_profile,
    read_bin_edges,
    simulate_impacts,
    tabulate_bins,
)
from ._machine import build_machine, column
from .protocol import Result, declare

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


COLOURS = {"upper": COUPLED, "lower": ACCENT}


def plot_wear(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """The profile of energies, and the effective part of each wall that is worn, over the number of bins:
    level for impacts that are spread, falling as one over it for spots (dotted)."""
    mosaic = [["profile", "profile", "share"]]
    figure, axes = create_figure("Wear: energy that impacts take", values, 9.2, 3.4, mosaic=mosaic)
    profile, worn, bins = axes["profile"], axes["share"], data["bins"].values
    draw_profile(profile, read_bin_edges(data), data["upper"].values, -data["lower"].values)
    profile.set_ylabel("energy per cycle / (M l² Ω²)")
    for wall, colour in COLOURS.items():
        if data[f"{wall}_energy"] > 0.0:
            share = data[f"{wall}_worn_share"].values
            worn.plot(bins, share, "o-", ms=3.5, color=colour, label=f"{wall} wall")
            worn.plot(bins, share[0] * bins[0] / bins, ls=":", lw=0.9, color=colour)
    worn.set_xscale("log")
    worn.set_yscale("log")
    worn.set_ylim(top=1.3)
    worn.set_xticks(bins)
    worn.xaxis.set_major_formatter(ScalarFormatter())
    worn.xaxis.set_minor_formatter(NullFormatter())
    worn.yaxis.set_major_formatter(ScalarFormatter())
    worn.annotate("dotted: spots", (0.06, 0.05), xycoords="axes fraction", fontsize=7.5, color=MUTED)
    worn.set_xlabel("bins")
    worn.set_ylabel("worn share of the wall")
    add_legend(figure, profile)
    return figure


ANALYSIS = declare(
    name="wear",
    description="Wear: energy that impacts take along the walls, and how evenly",
    parameters=declare_impacts(3000, 100),
    results={**_results("upper"), **_results("lower"), **COUNTS},
    table=build_table,
    draw=plot_wear,
)
