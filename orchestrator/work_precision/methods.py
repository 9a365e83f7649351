"""Our own masters, each over the problem's macro steps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from models.quantities import Vector

from .. import assembly
from ..errors import RunError
from ..masters import GaussSeidel, Iterated, Jacobi, Master
from ..participants import Participant
from ..signals import DEGREES
from ..simulation import Statistics, simulate
from .problem import CouplingProblem
from .run import Row, errors_of

TOOL = "tribocosim"
# A run is repeated, up to REPEATS times in all, until the runs took this long together; the shortest counts.
ENOUGH_S = 0.2
REPEATS = 3

HELD = "hold"
METHODS: dict[str, Master] = {
    f"{name}, {extrapolation}": kind(extrapolation)
    for name, kind in (("jacobi", Jacobi), ("gauss_seidel", GaussSeidel), ("iterated", Iterated))
    for extrapolation in DEGREES
}


def ladder(problem: CouplingProblem, name: str) -> tuple[float, ...]:
    """The macro steps (s) for METHODS[name]."""
    return problem.held_ladder if name.endswith(HELD) else problem.ladder


class Calls:
    """Counts the steps of participants."""

    def __init__(self, participants: Iterable[Participant]) -> None:
        self.count = 0
        for participant in participants:
            self._watch(participant)

    def _watch(self, participant: Any) -> None:
        advance = participant.advance

        def counted(time: float, step: float) -> None:
            self.count += 1
            advance(time, step)

        participant.advance = counted


@dataclass
class Samples:
    """An observer that keeps some outputs of every `every`-th step; the start is none."""

    names: Sequence[str]
    every: int
    rows: list[Vector] = field(default_factory=list)
    _steps: int = -1

    def begin(self, names: Sequence[str]) -> None:
        self._columns = [list(names).index(name) for name in self.names]

    def observe(self, time: float, outputs: Callable[[], Vector], iterations: int) -> None:
        self._steps += 1
        if self._steps and self._steps % self.every == 0:
            self.rows.append(outputs()[self._columns])

    def end(self, complete: bool, message: str) -> None:
        pass


def measured(
    problem: CouplingProblem,
    files: Mapping[str, assembly.FmuFile],
    truth: Vector,
    name: str,
    step: float,
) -> Row:
    """A run of the master METHODS[name] with the macro step (s).

    Steps are counted and samples taken while the clock runs, which costs about a hundredth of the time.
    """
    runs: list[tuple[int, Statistics]] = []
    while len(runs) < REPEATS and sum(run.coupled_time_s for _, run in runs) < ENOUGH_S:
        samples = Samples(problem.outputs, round(problem.spacing / step))
        try:
            runs.append(_run(problem, files, METHODS[name], step, samples))
        except RunError as error:
            return Row(name, TOOL, step, note=str(error))
    calls, statistics = runs[0]
    return Row(
        method=name,
        tool=TOOL,
        setting=step,
        macro_steps=statistics.macro_steps,
        rejected_steps=statistics.rejected_steps,
        iterations=statistics.iterations,
        calls=calls,
        wall_time_s=min(run.coupled_time_s for _, run in runs),
        **errors_of(problem.outputs, np.array(samples.rows), truth),
    )


def _run(
    problem: CouplingProblem,
    files: Mapping[str, assembly.FmuFile],
    master: Master,
    step: float,
    samples: Samples,
) -> tuple[int, Statistics]:
    """The number of steps of all participants, and the run's statistics."""
    participants = assembly.participants_of(problem.system, files)
    calls = Calls(participants.values())
    try:
        statistics = simulate(problem.system, participants, master, step, problem.duration, [samples])
    finally:
        for participant in participants.values():
            participant.close()
    return calls.count, statistics
