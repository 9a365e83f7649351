"""Lyapunov exponents of the slider-crank with clearance."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray

from ._machine import MACHINE, START, declare_duration, simulate_motion
from ._table import column, draw_by
from .protocol import Analysis, Result

# Windows of the table at most.
WINDOWS = 200


def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
    found = simulate_motion(values).exponents(values["cycles"])
    slides = math.isinf(found.largest)
    return {
        "largest": found.largest,
        "second": found.second,
        "uncertainty": found.uncertainty,
        "sum_rule_error": 0.0 if slides else found.largest + found.second - found.exact_sum,
        "impacts_per_cycle": found.impacts_per_cycle,
        "motion": "slides" if slides else "bounces",
    }


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    """The results, and both exponents of windows that follow one another."""
    cycles = values["cycles"]
    growths, _, length = simulate_motion(values).growths(cycles, min(WINDOWS, cycles))
    local = np.where(np.isfinite(growths), growths, -np.inf) / (2.0 * math.pi * length)
    meaning = f"over {length} cycles; -inf: slides"
    return xarray.Dataset(
        {
            "largest_in_window": column("window", local[:, 0], "1/rad", f"largest {meaning}"),
            "second_in_window": column("window", local[:, 1], "1/rad", f"second {meaning}"),
            "window_end": column("window", length * np.arange(1.0, len(local) + 1.0), "1", "cycles so far"),
            **evaluate(values),
        }
    )


ANALYSIS = Analysis(
    name="exponents",
    description="Lyapunov exponents of the slider-crank with clearance",
    parameters={**MACHINE, **START, **declare_duration(2000, 200)},
    results={
        "largest": Result("1/rad", "largest Lyapunov exponent per crank angle; -inf: slides"),
        "second": Result("1/rad", "second Lyapunov exponent per crank angle; -inf: slides"),
        "uncertainty": Result("1/rad", "standard error of the largest"),
        "sum_rule_error": Result(
            "1/rad", "sum of the exponents less -lambda/a + 2 N ln e/(2 pi), N impacts a cycle"
        ),
        "impacts_per_cycle": Result("1", "impacts per crank cycle"),
        "motion": Result("1", "slides (its memory ends) or bounces", text=True),
    },
    evaluate=evaluate,
    table=build_table,
    draw=draw_by("maps.convergence", "plot_exponents"),
)
