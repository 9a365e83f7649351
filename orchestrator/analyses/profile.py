"""Impact distribution profile."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import xarray

from models.slider_crank.motions.statistics import impact_profile

from ._impacts import (
    COUNTS,
    PER,
    VELOCITY,
    binned,
    counts,
    edges_of,
    impacts_of,
    parameters,
    total_of,
    velocities_of,
)
from ._table import scalars
from .protocol import Analysis, Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def table(values: Mapping[str, Any]) -> xarray.Dataset:
    impacts = impacts_of(values)
    found = impact_profile(
        impacts, velocities_of(impacts, values), values["xi"], values["bins"], total_of(impacts, values)
    )
    profile = binned(found, "1", "place on the wall x / l", f"sum of impact velocities per {values['per']}")
    return profile.assign(
        **counts(impacts, values["cycles"]), upper_sum=found.upper.sum(), lower_sum=found.lower.sum()
    )


def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
    return scalars(table(values))


def draw(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    from ..plots.motion.distribution import draw_profile
    from ..plots.motion.titles import legend, titled

    figure, axes = titled("Impact distribution profile", values, width=6.8, height=3.2)
    draw_profile(axes, edges_of(data), data["upper"].values, data["lower"].values)
    axes.set_ylabel(f"⟨{'ψ′' if values['velocity'] == 'psi_rate' else 'approach'}⟩ per {values['per']}")
    legend(figure, axes)
    return figure


ANALYSIS = Analysis(
    name="profile",
    description="Impact distribution profile: impact velocities along the walls (F 3.6)",
    parameters={**parameters(3000, 100), "velocity": VELOCITY, "per": PER},
    results={
        **COUNTS,
        "upper_sum": Result("1", "sum over the upper wall"),
        "lower_sum": Result("1", "sum over the lower wall (negative)"),
    },
    evaluate=evaluate,
    table=table,
    draw=draw,
)
