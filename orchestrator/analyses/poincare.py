"""Poincaré map of impacts on one wall."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import xarray

from models.slider_crank.flight.bouncing import LOWER, UPPER

from ._impacts import COUNTS, counts, first_impacts
from ._machine import MACHINE, START, duration
from ._table import column, scalars
from .protocol import Analysis, Parameter, Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def table(values: Mapping[str, Any]) -> xarray.Dataset:
    impacts, cycles = first_impacts(values)
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
            **counts(impacts, cycles),
        }
    )


def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
    return scalars(table(values))


def draw(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    from ..plots.motion.poincare import draw_poincare, magnified
    from ..plots.motion.titles import titled

    theta, rate = data["theta"].values, data["psi_rate"].values
    if not theta.size:
        figure, axes = titled(f"Poincaré map, {values['wall']} wall: no impacts", values, 6.0, 4.0)
        draw_poincare(axes, theta, rate)
        return figure
    figure, axes = titled(
        f"Poincaré map, {values['wall']} wall", values, 9.6, 4.4,
        mosaic=[["all", "all", "first"], ["all", "all", "second"]],
    )  # fmt: skip
    centre, by = (values["centre_angle"], values["centre_rate"]), values["magnification"]
    first, second = (magnified(theta, rate, centre, factor) for factor in (by, by * by))
    draw_poincare(axes["all"], theta, rate, marks=[first])
    draw_poincare(axes["first"], theta, rate, first, marks=[second], label=False)
    draw_poincare(axes["second"], theta, rate, second, label=False)
    for name, factor in (("first", by), ("second", by * by)):
        axes[name].set_title(f"× {factor:g}", fontsize=9, loc="left")
    return figure


ANALYSIS = Analysis(
    name="poincare",
    description="Poincaré map: impacts on one wall, velocity over crank angle, magnified twice (F 3.5)",
    parameters={
        **MACHINE,
        **START,
        **duration(40_000, 200),
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
    evaluate=evaluate,
    table=table,
    draw=draw,
)
