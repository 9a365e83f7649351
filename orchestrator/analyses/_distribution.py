"""Impact velocities summed along the walls and around the crank cycle: two tables of one kind."""

from collections.abc import Callable, Mapping
from typing import Any

import xarray

from models.core.quantities import Vector
from models.slider_crank.motions.machine import Events
from models.slider_crank.motions.statistics import (
    Distribution,
    approach_velocities,
    impact_profile,
    impact_spectrum,
)

from ..plots.motion.distribution import plot_profile, plot_spectrum
from ._impacts import COUNTS, count_impacts, declare_impacts, simulate_impacts, tabulate_bins
from ._table import evaluate_by
from .protocol import Analysis, Draw, Parameter, Result

PSI_RATE, APPROACH = "psi_rate", "approach"
IMPACT, CYCLE = "impact", "cycle"


def _declare(
    name: str,
    description: str,
    bins: int,
    edges: tuple[str, str],
    draw: Draw,
    distribute: Callable[[Events, Vector, Mapping[str, Any], float], Distribution],
) -> Analysis:
    """The analysis with this number of `bins` as default; `edges`: unit and meaning of their edges."""

    def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
        impacts = simulate_impacts(values)
        velocities = impacts.rate if values["velocity"] == PSI_RATE else approach_velocities(impacts)
        total = float(max(impacts.theta.size, 1) if values["per"] == IMPACT else values["cycles"])
        found = distribute(impacts, velocities, values, total)
        table = tabulate_bins(found, *edges, f"sum of impact velocities per {values['per']}")
        sums = {"upper_sum": found.upper.sum(), "lower_sum": found.lower.sum()}
        return table.assign({**count_impacts(impacts, values["cycles"]), **sums})

    return Analysis(
        name=name,
        description=description,
        parameters={
            **declare_impacts(3000, bins),
            "velocity": Parameter(
                PSI_RATE,
                "1",
                "psi' (F), or the slider's velocity relative to the wall",
                choices=(PSI_RATE, APPROACH),
            ),
            "per": Parameter(
                IMPACT, "1", "sums over the number of all impacts (F), or of cycles", choices=(IMPACT, CYCLE)
            ),
        },
        results={
            **COUNTS,
            "upper_sum": Result("1", "sum over the upper wall"),
            "lower_sum": Result("1", "sum over the lower wall (negative)"),
        },
        evaluate=evaluate_by(build_table),
        table=build_table,
        draw=draw,
    )


PROFILE = _declare(
    "profile",
    "Impact distribution profile: impact velocities along the walls (F 3.6)",
    100,
    ("1", "place on the wall x / l"),
    plot_profile,
    lambda impacts, velocities, values, total: impact_profile(
        impacts, velocities, values["xi"], values["bins"], total
    ),
)
SPECTRUM = _declare(
    "spectrum",
    "Impact spectra: impact velocities around the crank cycle (F 3.7)",
    120,
    ("rad", "crank angle"),
    plot_spectrum,
    lambda impacts, velocities, values, total: impact_spectrum(impacts, velocities, values["bins"], total),
)
