"""Chaotic, transiently chaotic or periodic, with the evidence."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray

from models.slider_crank.motions.classification import classify, finite_time_exponents
from models.slider_crank.motions.machine import Motion

from ._axes import report_mistakes
from ._machine import MACHINE, START, build_machine
from ._table import column, draw_by, evaluate_by
from .protocol import Analysis, Parameter, Result

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


ANALYSIS = Analysis(
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
    evaluate=evaluate_by(build_table),
    table=build_table,
    draw=draw_by("maps.classification", "plot_classification"),
)
