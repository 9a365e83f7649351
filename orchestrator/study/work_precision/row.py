"""The result of one run of a master, ours or another tool's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from models.core.difference import difference
from models.core.quantities import Vector

from ...run.plan import FmuFile
from ...scenario.system import Builder
from .problem import CouplingProblem

# Relative difference up to which times are the same.
ROUNDING = 1e-9


@dataclass(frozen=True)
class Row:
    """One run. `setting` is the macro step (s), or the tolerance of a run with step control.

    `error` and `max_error` are the largest over the outputs of the RMS and the maximum error, relative to
    the true output's spread; NaN where the run failed, and `note` says why. `calls` counts doStep of all
    instances, also those that were taken back. `wall_time_s` is that of the stepping alone.
    """

    method: str
    tool: str
    setting: float
    macro_steps: int = 0
    rejected_steps: int = 0
    iterations: int = 0
    calls: int = 0
    wall_time_s: float = np.nan
    error: float = np.nan
    max_error: float = np.nan
    errors: Mapping[str, float] = field(default_factory=dict)
    note: str = ""


def compute_errors(problem: CouplingProblem, times: Vector, values: Vector) -> dict[str, Any]:
    """The row's errors for the outputs (n, outputs) at `times`, which end with the problem's duration.

    Errors at other times than the samples' are interpolated to these, so that all runs have equal weights.
    """
    truth = problem.truth(problem.times)
    if len(times) == len(problem.times) and np.allclose(times, problem.times, rtol=ROUNDING, atol=0.0):
        error = values - truth
    else:
        # Each time costs a matrix exponential, so only times next to samples are used.
        after = np.minimum(np.searchsorted(times, problem.times * (1.0 - ROUNDING)), len(times) - 1)
        near = np.unique([np.maximum(after - 1, 0), after])
        own = values[near] - problem.truth(times[near])
        error = np.column_stack(
            [np.interp(problem.times, [0.0, *times[near]], [0.0, *column]) for column in own.T]
        )
    found = [difference(truth[:, i] + error[:, i], truth[:, i]) for i in range(len(problem.outputs))]
    relative = [d.max_abs * d.relative_rms / d.rms if d.rms > 0.0 else 0.0 for d in found]
    return {
        "error": max(d.relative_rms for d in found),
        "max_error": max(relative),
        "errors": {name: d.relative_rms for name, d in zip(problem.outputs, found, strict=True)},
    }


def build_fmus(problem: CouplingProblem, build: Builder) -> dict[str, FmuFile]:
    """The FMU of every instance."""
    return {
        name: FmuFile(Path(build(i.component.name, i.component.structure, "fmu")), "")
        for name, i in problem.system.instances.items()
    }
