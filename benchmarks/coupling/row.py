"""The result of one run of a master."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from models.core.difference import difference
from models.core.quantities import Vector
from orchestrator.run.plan import FmuFile
from orchestrator.scenario.system import Builder

from .problem import CouplingProblem

# Relative difference up to which times are the same.
ROUNDING = 1e-9


@dataclass(frozen=True)
class Row:
    """One run. `setting` is the macro step (s), or the tolerance of a run with step control.

    `errors`: RMS error of each output, relative to the true output's spread; empty where the run failed, and
    `note` says why. `calls` counts doStep of all instances, also those that were taken back.
    """

    method: str
    setting: float
    calls: int = 0
    errors: Mapping[str, float] = field(default_factory=dict)
    note: str = ""

    @property
    def error(self) -> float:
        """The largest error; NaN where the run failed."""
        return max(self.errors.values(), default=np.nan)


def compute_errors(problem: CouplingProblem, times: Vector, values: Vector) -> dict[str, float]:
    """Relative RMS errors of the outputs (n, outputs) at `times`, which end with the problem's duration.

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
    return {
        name: difference(truth[:, i] + error[:, i], truth[:, i]).relative_rms
        for i, name in enumerate(problem.outputs)
    }


def build_fmus(problem: CouplingProblem, build: Builder) -> dict[str, FmuFile]:
    """The FMU of every instance."""
    parts = {name: instance.component for name, instance in problem.system.instances.items()}
    return {name: FmuFile(build(c.name, c.structure, "fmu"), "") for name, c in parts.items()}
