"""Poincaré map of impacts on one wall."""

import math
from collections.abc import Mapping
from typing import Any

import xarray

from models.slider_crank.flight.bouncing import LOWER, UPPER

from ..plots.motion.poincare import plot_poincare
from ._impacts import COUNTS, count_impacts, simulate_first_impacts
from ._machine import MACHINE, START, declare_duration
from ._table import column, evaluate_by
from .protocol import Analysis, Parameter, Result


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    impacts, cycles = simulate_first_impacts(values)
    chosen = impacts.where(impacts.side == (UPPER if values["wall"] == "upper" else LOWER))
    return xarray.Dataset(
        {
            "cycle": column("impact", chosen.cycle, "1", "crank cycle since the start"),
            "theta": column("impact", chosen.theta, "rad", "crank angle"),
            "psi_rate": column("impact", chosen.rate, "1", "psi' before the impact, per crank angle"),
            "approach": column("impact", chosen.approach, "1", "velocity towards the wall, over l Omega"),
            "onset": column("impact", chosen.kind, "1", "1: sliding begins"),
            "points": chosen.theta.size,
            "seen": cycles,
            **count_impacts(impacts, cycles),
        }
    )


ANALYSIS = Analysis(
    name="poincare",
    description="Poincaré map: impacts on one wall, velocity over crank angle, magnified twice (F 3.5)",
    parameters={
        **MACHINE,
        **START,
        **declare_duration(40_000, 200),
        "most": Parameter(400_000, "1", "impacts after which it ends early", minimum=1.0, integer=True),
        "wall": Parameter("upper", "1", "wall", choices=("upper", "lower")),
        "centre_angle": Parameter(
            1.0, "rad", "magnified: around the impact nearest to it", 0.0, 2.0 * math.pi
        ),
        "centre_rate": Parameter(0.06, "1", "and to this psi'"),
        "magnification": Parameter(6.0, "1", "of the first window, and of the second over it", minimum=1.0),
    },
    results={
        "points": Result("1", "impacts on this wall"),
        "seen": Result("1", "crank cycles that they took"),
        **COUNTS,
    },
    evaluate=evaluate_by(build_table),
    table=build_table,
    draw=plot_poincare,
)
