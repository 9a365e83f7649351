"""Impacts along the walls and around the crank cycle: velocities, and energies with their spread."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import FuncFormatter, MaxNLocator, NullFormatter, ScalarFormatter

from models.core.quantities import Vector
from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.motions import histories as h
from models.slider_crank.motions.machine import Events
from models.slider_crank.motions.statistics import (
    Distribution,
    approach_velocities,
    effective_bins,
    energies,
    energy_profile,
    impact_profile,
    impact_spectrum,
    sampling_bias,
    uniformity,
)

from ..plots.motion import add_legend, create_figure, format_angle
from ..plots.style import ACCENT, COUPLED, MUTED
from ._machine import MACHINE, START, build_machine, column, declare_duration, simulate_motion
from .protocol import Analysis, Draw, Parameter, Result, declare

# Cycles after which impacts are counted again.
BATCH = 100
COUNTS = {
    "impacts_per_cycle": Result("1", "impacts per crank cycle"),
    "lower_per_cycle": Result("1", "of them on the lower wall"),
    "onsets_per_cycle": Result("1", "of them those with which sliding begins"),
}


def declare_impacts(cycles: int, bins: int) -> dict[str, Parameter]:
    """Machine, start, duration and bins, with these defaults."""
    wanted = Parameter(bins, "1", "equal parts that are summed over", minimum=2.0, integer=True)
    return {**MACHINE, **START, **declare_duration(cycles, 200), "bins": wanted}


def simulate_impacts(values: Mapping[str, Any]) -> Events:
    """The impacts of the motion after its transient."""
    return simulate_motion(values).events(values["cycles"]).impacts


def simulate_first_impacts(values: Mapping[str, Any]) -> tuple[Events, int]:
    """The same until there are `most` (to the end of the `BATCH` of cycles), and the cycles that took.

    A motion that slides has hundreds of impacts a cycle.
    """
    motion, cycles, most = simulate_motion(values), values["cycles"], values["most"]
    batches = []
    begun, count = motion.cycle, 0
    while count < most and (left := begun + cycles - motion.cycle) > 0:
        batches.append(motion.events(min(left, BATCH)).impacts)
        count += batches[-1].theta.size
    columns = (np.concatenate(column) for column in zip(*batches, strict=True))
    return Events(*columns), motion.cycle - begun


def count_impacts(impacts: Events, cycles: int) -> dict[str, float]:
    """Values of `COUNTS`."""
    return {
        "impacts_per_cycle": impacts.theta.size / cycles,
        "lower_per_cycle": np.count_nonzero(impacts.side < 0.0) / cycles,
        "onsets_per_cycle": np.count_nonzero(impacts.kind == h.ONSET) / cycles,
    }


def tabulate_bins(found: Distribution, unit: str, place: str, meaning: str) -> xarray.Dataset:
    """A table with a row for each bin; `unit` and `place`: of the edges."""
    return xarray.Dataset(
        {
            "start": column("bin", found.edges[:-1], unit, f"{place} at which the bin begins"),
            "end": column("bin", found.edges[1:], unit, f"{place} at which it ends"),
            "upper": column("bin", found.upper, "1", f"{meaning}, upper wall"),
            "lower": column("bin", found.lower, "1", f"{meaning}, lower wall"),
        }
    )


PSI_RATE, APPROACH = "psi_rate", "approach"
IMPACT, CYCLE = "impact", "cycle"


def read_bin_edges(data: xarray.Dataset) -> Vector:
    """Edges of the bins of a table."""
    edges: Vector = np.append(data["start"].values, data["end"].values[-1])
    return edges


def draw_profile(axes: Axes, edges: Vector, upper: Vector, lower: Vector) -> None:
    """Bars along the wall: the upper wall's values upwards, the lower one's (negative) downwards."""
    for values, colour, words in ((upper, COUPLED, "upper wall"), (lower, ACCENT, "lower wall")):
        axes.stairs(values, edges, fill=True, color=colour, alpha=0.85, lw=0.0, label=words)
    axes.axhline(0.0, color=MUTED, lw=0.8)
    axes.set_xlim(edges[0], edges[-1])
    axes.yaxis.set_major_locator(MaxNLocator(6, symmetric=True))
    axes.set_xlabel("place on the wall x / l  (left: θ = π, right: θ = 0)")


def draw_spectrum(axes: PolarAxes, edges: Vector, values: Vector, colour: str = COUPLED) -> None:
    """Bars around the revolution, as long as the values are large; the scale stands on the emptier side."""
    axes.bar(
        edges[:-1],
        np.abs(values),
        width=np.diff(edges),
        align="edge",
        color=colour,
        alpha=0.85,
        linewidth=0.0,
    )
    axes.set_xticks(0.25 * math.pi * np.arange(8))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda angle, _: _format_eighth(angle)))
    if np.any(values):
        axes.yaxis.set_major_locator(MaxNLocator(4))
    else:
        axes.set_yticks([])
    axes.tick_params(axis="y", labelsize=7.0, labelcolor="#55606b")
    middles = 0.5 * (edges[:-1] + edges[1:])
    heavy = float(np.angle(np.sum(np.abs(values) * np.exp(1j * middles))))
    axes.set_rlabel_position(math.degrees(heavy) + 180.0)
    axes.spines["polar"].set_color(MUTED)


def _format_eighth(angle: float) -> str:
    quarters = round(4.0 * angle / math.pi)
    return format_angle(angle) if quarters % 2 == 0 else f"{'' if quarters == 1 else quarters}π/4"


def plot_profile(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    figure, axes = create_figure("Impact distribution profile", values, width=6.8, height=3.2)
    draw_profile(axes, read_bin_edges(data), data["upper"].values, data["lower"].values)
    axes.set_ylabel(f"⟨{'ψ′' if values['velocity'] == 'psi_rate' else 'approach'}⟩ per {values['per']}")
    add_legend(figure, axes)
    return figure


def plot_spectrum(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    polar = {"projection": "polar"}
    figure, axes = create_figure(
        "Impact spectra", values, 7.2, 3.7, mosaic=[["upper", "lower"]], subplot_kw=polar
    )
    for wall, colour in (("upper", COUPLED), ("lower", ACCENT)):
        draw_spectrum(axes[wall], read_bin_edges(data), data[wall].values, colour)
        none = "" if data[wall].values.any() else ": no impacts"
        axes[wall].set_title(f"{wall} wall{none}", fontsize=9)
    return figure


def _declare(
    name: str,
    description: str,
    bins: int,
    edges: tuple[str, str],
    draw: Draw,
    distribute: Callable[[Events, Vector, Mapping[str, Any], float], Distribution],
) -> Analysis:
    """The analysis with this number of `bins` as default; `edges`: unit and meaning of their edges."""

    def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
        impacts = simulate_impacts(values)
        velocities = impacts.rate if values["velocity"] == PSI_RATE else approach_velocities(impacts)
        total = float(max(impacts.theta.size, 1) if values["per"] == IMPACT else values["cycles"])
        found = distribute(impacts, velocities, values, total)
        table = tabulate_bins(found, *edges, f"sum of impact velocities per {values['per']}")
        sums = {"upper_sum": found.upper.sum(), "lower_sum": found.lower.sum()}
        return table.assign({**count_impacts(impacts, values["cycles"]), **sums})

    return declare(
        name=name,
        description=description,
        parameters={
            **declare_impacts(3000, bins),
            "velocity": Parameter(
                PSI_RATE,
                "1",
                "psi' (F), or the slider's velocity relative to the wall",
                choices=(PSI_RATE, APPROACH),
            ),
            "per": Parameter(
                IMPACT, "1", "sums over the number of all impacts (F), or of cycles", choices=(IMPACT, CYCLE)
            ),
        },
        results={
            **COUNTS,
            "upper_sum": Result("1", "sum over the upper wall"),
            "lower_sum": Result("1", "sum over the lower wall (negative)"),
        },
        table=build_table,
        draw=draw,
    )


PROFILE = _declare(
    "profile",
    "Impact distribution profile: impact velocities along the walls (F 3.6)",
    100,
    ("1", "place on the wall x / l"),
    plot_profile,
    lambda impacts, velocities, values, total: impact_profile(
        impacts, velocities, values["xi"], values["bins"], total
    ),
)
SPECTRUM = _declare(
    "spectrum",
    "Impact spectra: impact velocities around the crank cycle (F 3.7)",
    120,
    ("rad", "crank angle"),
    plot_spectrum,
    lambda impacts, velocities, values, total: impact_spectrum(impacts, velocities, values["bins"], total),
)


# The number of bins is also taken smaller and larger, to show what depends on it.
FACTORS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
WALLS = {"upper": UPPER, "lower": LOWER}


def tabulate_wear(values: Mapping[str, Any]) -> xarray.Dataset:
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


WEAR = declare(
    name="wear",
    description="Wear: energy that impacts take along the walls, and how evenly",
    parameters=declare_impacts(3000, 100),
    results={**_results("upper"), **_results("lower"), **COUNTS},
    table=tabulate_wear,
    draw=plot_wear,
)
