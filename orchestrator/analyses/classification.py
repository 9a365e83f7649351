"""Chaotic, transiently chaotic or periodic, with the evidence."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from models.slider_crank.motions.classification import classify, finite_time_exponents
from models.slider_crank.motions.machine import Motion

from ..plots.motion import create_figure
from ..plots.style import ACCENT, COUPLED, MUTED, REFERENCE
from ._machine import MACHINE, START, build_machine, column, report_mistakes
from .protocol import Parameter, Result, declare

# Cycles shown in the figure, at most, and windows of finite-time exponents in it.
MOST_SHOWN, WINDOWS = 10_000, 150


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
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


ANALYSIS = declare(
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
    table=build_table,
    draw=plot_classification,
)
