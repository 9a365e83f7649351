"""Whether and when a motion settles: chaotic, transiently chaotic or periodic; lengths of transients."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from models.slider_crank.motions.classification import classify, finite_time_exponents
from models.slider_crank.motions.machine import Motion
from models.slider_crank.motions.transients import (
    ORDINARY_TRANSIENT,
    draw_starts,
    fit_escape_time,
    measure_transients,
)

from ..plots.motion import add_legend, create_figure
from ..plots.style import ACCENT, COUPLED, MUTED, REFERENCE
from ._machine import MACHINE, START, build_machine, column, report_mistakes, show_points
from .protocol import Parameter, Result, declare

# Cycles shown in the figure, at most, and windows of finite-time exponents in it.
MOST_SHOWN, WINDOWS = 10_000, 150


def tabulate_classification(values: Mapping[str, Any]) -> xarray.Dataset:
    machine, start = build_machine(values), (values["psi"], values["psi_rate"])
    with report_mistakes():
        found = classify(machine, values["cycles"], *start)
    shown = min(MOST_SHOWN, max(60, 3 * found.transient // 2), found.cycles)
    window = max(5, shown // WINDOWS)
    local = finite_time_exponents(Motion(machine, *start), shown, window)
    return xarray.Dataset(
        {
            "psi": column(
                "cycle", Motion(machine, *start).strobe(shown)[:, 0], "rad", "psi at crank angle 0"
            ),
            "finite_time_exponent": column("window", local, "1/rad", f"largest, over {window} cycles"),
            "window_end": column(
                "window", window * np.arange(1.0, len(local) + 1.0), "1", "cycles since the start"
            ),
            "kind": found.kind,
            "period": float(found.period),
            "transient": float(found.transient),
            "exponent": found.exponent,
            "uncertainty": found.uncertainty,
            "impacts_per_cycle": found.impacts_per_cycle,
            "evidence": found.evidence,
        },
        coords={"cycle": np.arange(1, shown + 1)},
    )


def plot_classification(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """Two axes over the same cycles; `data` has psi (cycle), finite_time_exponent (window), the results."""
    title = f"Classification: {data['kind'].item()}"
    figure, axes = create_figure(title, values, width=6.8, height=4.4, mosaic="A;B", sharex=True)
    states, exponents = axes["A"], axes["B"]
    cycle = data["cycle"].values
    size = min(4.0, max(0.5, 4e3 / len(cycle)))
    states.scatter(cycle, 1e3 * data["psi"].values, s=size, color=COUPLED, lw=0, rasterized=True)
    states.set_ylabel("ψ at crank angle 0 (mrad)")
    states.margins(x=0.01)
    local = data["finite_time_exponent"].values
    slides = np.isneginf(local)
    end = data["window_end"].values
    exponents.axhline(0.0, color=MUTED, lw=0.8)
    exponents.plot(end, np.where(slides, np.nan, local), color=COUPLED, lw=0.9, marker=".", ms=2.5)
    if slides.any():
        exponents.plot(
            end[slides], np.full(slides.sum(), 0.03), ls="", marker="|", ms=5, color=ACCENT,
            transform=exponents.get_xaxis_transform(), label="slides",
        )  # fmt: skip
    if data["period"].item() and cycle[0] < data["transient"].item() < cycle[-1]:
        for panel in (states, exponents):
            panel.axvline(data["transient"].item(), color=REFERENCE, lw=1.0, ls=(0, (5, 3)))
        exponents.plot([], [], color=REFERENCE, lw=1.0, ls=(0, (5, 3)), label="settled")
    if exponents.get_legend_handles_labels()[0]:
        exponents.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
    exponents.set_ylabel("finite-time\nexponent (1/rad)")
    exponents.set_xlabel("cycle")
    return figure


CLASSIFICATION = declare(
    name="classification",
    description="Periodic, chaotic or transiently chaotic, with the evidence",
    parameters={
        **MACHINE,
        **START,
        "cycles": Parameter(100_000, "1", "cycles that it is looked at for", minimum=1.0, integer=True),
    },
    results={
        "kind": Result("1", "periodic, chaotic, transient chaos or undecided", text=True),
        "period": Result("1", "cycles after which it repeats, 0: none found"),
        "transient": Result("1", "cycles before it is on its orbit; all if there is none"),
        "exponent": Result("1/rad", "largest Lyapunov exponent in the end; -inf: slides"),
        "uncertainty": Result("1/rad", "its standard error"),
        "impacts_per_cycle": Result("1", "impacts per crank cycle in the end"),
        "evidence": Result("1", "what the classification rests on", text=True),
    },
    table=tabulate_classification,
    draw=plot_classification,
)


def tabulate_transients(values: Mapping[str, Any]) -> xarray.Dataset:
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


TRANSIENT = declare(
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
    table=tabulate_transients,
    draw=plot_transient,
)
