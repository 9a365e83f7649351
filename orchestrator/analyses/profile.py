"""Impact distribution profile."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import xarray

from models.core.quantities import Vector
from models.slider_crank.machine import Events
from models.slider_crank.motions.statistics import Distribution, impact_profile

from ._impacts import PER, SUMS, VELOCITY, edges_of, parameters, summed
from ._table import scalars
from .protocol import Analysis

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def table(values: Mapping[str, Any]) -> xarray.Dataset:
    def distribute(impacts: Events, velocities: Vector, total: float) -> Distribution:
        return impact_profile(impacts, velocities, values["xi"], values["bins"], total)

    return summed(values, distribute, "1", "place on the wall x / l")


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
    results=SUMS,
    evaluate=evaluate,
    table=table,
    draw=draw,
)
