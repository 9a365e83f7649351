"""Impact spectra."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import xarray

from models.core.quantities import Vector
from models.slider_crank.machine import Events
from models.slider_crank.motions.statistics import Distribution, impact_spectrum

from ._impacts import PER, SUMS, VELOCITY, edges_of, parameters, summed
from ._table import scalars
from .protocol import Analysis

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def table(values: Mapping[str, Any]) -> xarray.Dataset:
    def distribute(impacts: Events, velocities: Vector, total: float) -> Distribution:
        return impact_spectrum(impacts, velocities, values["bins"], total)

    return summed(values, distribute, "rad", "crank angle")


def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
    return scalars(table(values))


def draw(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    from ..plots.motion.distribution import draw_spectrum
    from ..plots.motion.titles import titled
    from ..plots.style import ACCENT, COUPLED

    polar = {"projection": "polar"}
    figure, axes = titled("Impact spectra", values, 7.2, 3.7, mosaic=[["upper", "lower"]], subplot_kw=polar)
    for wall, colour in (("upper", COUPLED), ("lower", ACCENT)):
        draw_spectrum(axes[wall], edges_of(data), data[wall].values, colour)
        none = "" if data[wall].values.any() else ": no impacts"
        axes[wall].set_title(f"{wall} wall{none}", fontsize=9)
    return figure


ANALYSIS = Analysis(
    name="spectrum",
    description="Impact spectra: impact velocities around the crank cycle (F 3.7)",
    parameters={**parameters(3000, 120), "velocity": VELOCITY, "per": PER},
    results=SUMS,
    evaluate=evaluate,
    table=table,
    draw=draw,
)
