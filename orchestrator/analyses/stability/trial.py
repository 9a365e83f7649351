"""Runs of a scenario's equations in this process, with their errors against the true motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from time import process_time
from typing import Any

import numpy as np
from scipy.interpolate import make_interp_spline

from models.core.difference import difference
from models.core.quantities import Vector

from ...engine.coupling import Coupling
from ...engine.observer import Observer
from ...engine.step import Step
from ...errors import MistakeError, RunError
from ...masters import Master
from ...run.plan import open_participants, plan_participants
from ...run.simulation import simulate
from ...scenario.system import Resolved
from ...stepping import Stepper

# Instants at which errors are sampled.
SAMPLES = 1000
TOO_MANY = "more doSteps than the best"


@dataclass(frozen=True)
class Outcome:
    """A run: its choice, doSteps, and largest error over what is allowed (NaN and a note if it failed).

    `seconds` of the processor were taken."""

    choice: str
    steps: int = 0
    error: float = math.nan
    note: str = ""
    seconds: float = 0.0

    @property
    def good(self) -> bool:
        return self.error <= 1.0


@dataclass(frozen=True)
class Trial:
    """A scenario, and the true values at `times` (s) of the outputs that have a tolerance, a column each.

    It is run up to the last of the times."""

    resolved: Resolved
    times: Vector
    truth: Vector

    def run(self, name: str, master: Master, steps: Stepper, most: float = math.inf) -> Outcome:
        """Run with a master and these steps, and at most so many doSteps."""
        resolved = self.resolved
        trace = _Trace(list(resolved.scenario.tolerance), most)
        plans = plan_participants(resolved.scenario, resolved.assembly.linear, None)
        stop, lines = float(self.times[-1]), resolved.assembly.side_lines
        began, error, note = process_time(), math.nan, ""
        try:
            with open_participants(resolved.system, plans) as units:
                simulate(resolved.system, units, master, steps, stop, [trace], lines=lines)
            error = self._measure_error(trace)
        except (RunError, MistakeError) as failure:
            note = str(failure)
        return Outcome(name, int(np.sum(trace.calls)), error, note, process_time() - began)

    def _measure_error(self, trace: _Trace) -> float:
        """The largest relative RMS error over what is allowed."""
        at = np.array(trace.times)
        samples = np.linspace(0.0, self.times[-1], SAMPLES + 1)[1:]
        after = np.minimum(np.searchsorted(at, samples * (1.0 - 1e-9)), len(at) - 1)
        near = np.unique([np.maximum(after - 1, 0), after])
        worst = 0.0
        true, exact = self._course(at[near]), self._course(samples)
        for column, allowed in enumerate(self.resolved.scenario.tolerance.values()):
            off = np.array(trace.rows)[near, column] - true[:, column]
            error = np.interp(samples, [0.0, *at[near]], [0.0, *off])
            found = difference(exact[:, column] + error, exact[:, column])
            worst = max(worst, found.relative_rms / allowed)
        return worst

    @cached_property
    def _course(self) -> Callable[[Vector], Vector]:
        """The true outputs at any times: a cubic spline, or straight lines where impacts make them jump."""
        jumps = any(i.component.events for i in self.resolved.system.instances.values())
        spline: Callable[[Vector], Vector] = make_interp_spline(self.times, self.truth, k=1 if jumps else 3)
        return spline


@dataclass
class _Trace(Observer):
    """An observer that records some outputs at the end of every step, of which there are at most `most`
    calls of doStep."""

    names: Sequence[str]
    most: float = math.inf
    times: list[float] = field(default_factory=list)
    rows: list[Vector] = field(default_factory=list)
    calls: Any = 0

    def watch(self, coupling: Coupling) -> None:
        self.calls = coupling.calls

    def begin(self, names: Sequence[str]) -> None:
        self._columns = [list(names).index(name) for name in self.names]

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if step.length > 0.0:
            self.times.append(time)
            self.rows.append(outputs()[self._columns])
        if self.calls.sum() > self.most:
            raise RunError(TOO_MANY)
