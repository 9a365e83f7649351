"""Lyapunov exponents of the slider-crank with clearance."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from models.slider_crank.lyapunov import lyapunov_exponents

from .protocol import Analysis, Parameter, Result


def evaluate(values: Mapping[str, Any]) -> dict[str, float]:
    found = lyapunov_exponents(
        values["damping"],
        values["gap"],
        values["restitution"],
        corrected=values["form"] == "corrected",
        cycles=values["cycles"],
        transient=values["transient"],
    )
    return {
        "largest": found.largest,
        "second": found.second,
        "sum_rule_error": found.largest + found.second - found.exact_sum,
        "impacts_per_cycle": found.impacts_per_cycle,
    }


ANALYSIS = Analysis(
    name="exponents",
    description="Lyapunov exponents of the slider-crank with clearance",
    parameters={
        "damping": Parameter(0.05, "1", "viscous friction at the slider, F's lambda", minimum=0.0),
        "gap": Parameter(0.01, "1", "clearance over rod length, F's rho", positive=True),
        "restitution": Parameter(0.9, "1", "coefficient of restitution", positive=True, maximum=1.0),
        "form": Parameter(
            "as_published", "1", "sign of the rod's inertia", choices=("as_published", "corrected")
        ),
        "cycles": Parameter(2000, "1", "crank cycles averaged over", minimum=1.0, integer=True),
        "transient": Parameter(200, "1", "crank cycles left out before", minimum=0.0, integer=True),
    },
    results={
        "largest": Result("1/rad", "largest Lyapunov exponent per crank angle"),
        "second": Result("1/rad", "second Lyapunov exponent per crank angle"),
        "sum_rule_error": Result(
            "1/rad", "sum of the exponents less -lambda/a + 2 N ln e/(2 pi), N impacts a cycle"
        ),
        "impacts_per_cycle": Result("1", "impacts per crank cycle"),
    },
    evaluate=evaluate,
)
