"""Length of transient chaos over many starts."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from models.slider_crank.motions.transients import (
    ORDINARY_TRANSIENT,
    draw_starts,
    fit_escape_time,
    measure_transients,
)

from ..plots.motion import add_legend, create_figure
from ..plots.style import COUPLED, REFERENCE
from ._machine import MACHINE, build_machine, column, show_points
from .protocol import Parameter, Result, declare


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    machine = build_machine(values)
    starts = draw_starts(machine, values["starts"], values["seed"])
    found = measure_transients(machine, starts, values["cycles"], progress=show_points)
    fit = fit_escape_time(found)
    return xarray.Dataset(
        {
            "psi": column("start", starts[:, 0], "rad", "start, crank angle 0"),
            "psi_rate": column("start", starts[:, 1], "1", "its derivative by crank angle"),
            "length": column("start", found.lengths, "1", "cycles until settled, or seen"),
            "period": column("start", found.periods, "1", "period of the orbit in cycles, 0: not settled"),
            "settled_share": float(np.mean(found.settled)),
            "median": float(np.median(found.lengths)),
            "longest": float(found.lengths.max()),
            "mean_escape": fit.mean if fit else math.inf,
            "error": fit.error if fit else math.inf,
            "distance": fit.distance if fit else 1.0,
        }
    )


def plot_transient(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has length and period (0: not settled) of every start, mean_escape and its error."""
    figure, axes = create_figure("Length of transients", values, width=6.0, height=3.8)
    after, lengths = ORDINARY_TRANSIENT, data["length"].values
    settled = np.sort(lengths[data["period"].values > 0])
    left = 1.0 - np.arange(len(settled) + 1) / len(lengths)
    axes.step(
        np.concatenate([[0.0], settled, [lengths.max()]]),
        np.append(left, left[-1]),
        where="post", color=COUPLED, label="starts",
    )  # fmt: skip
    mean, error = data["mean_escape"].item(), data["error"].item()
    if np.isfinite(mean):
        t = np.linspace(after, max(lengths.max(), after + 1.0), 200)
        share = np.mean(lengths > after)
        axes.plot(
            t, share * np.exp(-(t - after) / mean), color=REFERENCE, lw=1.0, ls=(0, (5, 3)),
            label=f"exponential, mean {mean:.4g} ± {error:.2g}",
        )  # fmt: skip
    axes.set_yscale("log")
    axes.set_ylim(0.5 / len(lengths), 1.3)
    axes.set_xlim(left=0.0)
    axes.set_xlabel("cycles")
    axes.set_ylabel("part not yet on its orbit")
    add_legend(figure, axes)
    return figure


ANALYSIS = declare(
    name="transient",
    description="Length of transient chaos: distribution over random starts, mean escape time",
    parameters={
        **MACHINE,
        "starts": Parameter(400, "1", "random starts between the walls", minimum=1.0, integer=True),
        "seed": Parameter(0, "1", "seed of the starts", minimum=0.0, integer=True),
        "cycles": Parameter(10_000, "1", "cycles that a motion is looked at for", minimum=1.0, integer=True),
    },
    results={
        "mean_escape": Result("1", f"mean escape time in cycles, of transients beyond {ORDINARY_TRANSIENT}"),
        "error": Result("1", "its standard error"),
        "distance": Result("1", "largest difference from the exponential distribution"),
        "settled_share": Result("1", "part of the starts that settled on an orbit"),
        "median": Result("1", "median length in cycles"),
        "longest": Result("1", "longest length in cycles"),
    },
    table=build_table,
    draw=plot_transient,
)
