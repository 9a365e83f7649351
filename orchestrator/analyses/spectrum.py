"""Impact spectra."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray

from models.core.quantities import Vector
from models.slider_crank.motions.machine import Events
from models.slider_crank.motions.statistics import Distribution, impact_spectrum

from ._impacts import PER, SUMS, VELOCITY, declare_impacts, sum_velocities
from ._table import draw_by, evaluate_by
from .protocol import Analysis


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    def distribute(impacts: Events, velocities: Vector, total: float) -> Distribution:
        return impact_spectrum(impacts, velocities, values["bins"], total)

    return sum_velocities(values, distribute, "rad", "crank angle")


ANALYSIS = Analysis(
    name="spectrum",
    description="Impact spectra: impact velocities around the crank cycle (F 3.7)",
    parameters={**declare_impacts(3000, 120), "velocity": VELOCITY, "per": PER},
    results=SUMS,
    evaluate=evaluate_by(build_table),
    table=build_table,
    draw=draw_by("motion.distribution", "plot_spectrum"),
)
