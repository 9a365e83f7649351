"""Impacts of a motion, for the analyses of impacts."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray

from models.slider_crank.motions import histories as h
from models.slider_crank.motions.machine import Events
from models.slider_crank.motions.statistics import Distribution

from ._machine import MACHINE, START, column, declare_duration, simulate_motion
from .protocol import Parameter, Result

# Cycles after which impacts are counted again.
BATCH = 100
COUNTS = {
    "impacts_per_cycle": Result("1", "impacts per crank cycle"),
    "lower_per_cycle": Result("1", "of them on the lower wall"),
    "onsets_per_cycle": Result("1", "of them those with which sliding begins"),
}


def declare_impacts(cycles: int, bins: int) -> dict[str, Parameter]:
    """Machine, start, duration and bins, with these defaults."""
    wanted = Parameter(bins, "1", "equal parts that are summed over", minimum=2.0, integer=True)
    return {**MACHINE, **START, **declare_duration(cycles, 200), "bins": wanted}


def simulate_impacts(values: Mapping[str, Any]) -> Events:
    """The impacts of the motion after its transient."""
    return simulate_motion(values).events(values["cycles"]).impacts


def simulate_first_impacts(values: Mapping[str, Any]) -> tuple[Events, int]:
    """The same until there are `most` (to the end of the `BATCH` of cycles), and the cycles that took.

    A motion that slides has hundreds of impacts a cycle.
    """
    motion, cycles, most = simulate_motion(values), values["cycles"], values["most"]
    batches = []
    begun, count = motion.cycle, 0
    while count < most and (left := begun + cycles - motion.cycle) > 0:
        batches.append(motion.events(min(left, BATCH)).impacts)
        count += batches[-1].theta.size
    columns = (np.concatenate(column) for column in zip(*batches, strict=True))
    return Events(*columns), motion.cycle - begun


def count_impacts(impacts: Events, cycles: int) -> dict[str, float]:
    """Values of `COUNTS`."""
    return {
        "impacts_per_cycle": impacts.theta.size / cycles,
        "lower_per_cycle": np.count_nonzero(impacts.side < 0.0) / cycles,
        "onsets_per_cycle": np.count_nonzero(impacts.kind == h.ONSET) / cycles,
    }


def tabulate_bins(found: Distribution, unit: str, place: str, meaning: str) -> xarray.Dataset:
    """A table with a row for each bin; `unit` and `place`: of the edges."""
    return xarray.Dataset(
        {
            "start": column("bin", found.edges[:-1], unit, f"{place} at which the bin begins"),
            "end": column("bin", found.edges[1:], unit, f"{place} at which it ends"),
            "upper": column("bin", found.upper, "1", f"{meaning}, upper wall"),
            "lower": column("bin", found.lower, "1", f"{meaning}, lower wall"),
        }
    )
