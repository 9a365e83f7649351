"""Lyapunov exponents of the slider-crank with clearance."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ._machine import MACHINE, START, duration, motion_of
from .protocol import Analysis, Result


def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
    found = motion_of(values).exponents(values["cycles"])
    slides = math.isinf(found.largest)
    return {
        "largest": found.largest,
        "second": found.second,
        "uncertainty": found.uncertainty,
        "sum_rule_error": 0.0 if slides else found.largest + found.second - found.exact_sum,
        "impacts_per_cycle": found.impacts_per_cycle,
        "motion": "slides" if slides else "bounces",
    }


ANALYSIS = Analysis(
    name="exponents",
    description="Lyapunov exponents of the slider-crank with clearance",
    parameters={**MACHINE, **START, **duration(2000, 200)},
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
)
