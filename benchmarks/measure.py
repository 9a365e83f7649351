"""Timing by paired repetition: all candidates in turn, several rounds, the median of each."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping, Sequence

from models.core.quantities import Vector
from orchestrator.engine.step import Step


def measure_medians(candidates: Mapping[str, Callable[[], float]], rounds: int = 5) -> dict[str, float]:
    """The median figure of each candidate; each round runs all of them once, after one unmeasured round."""
    for candidate in candidates.values():
        candidate()
    figures: dict[str, list[float]] = {name: [] for name in candidates}
    for _ in range(rounds):
        for name, candidate in candidates.items():
            figures[name].append(candidate())
    return {name: statistics.median(found) for name, found in figures.items()}


class Clock:
    """An observer that takes the processor time of the stepping, `elapsed` (s).

    Other programs on the machine change it less than wall time.
    """

    def begin(self, names: Sequence[str]) -> None:
        pass

    def observe(self, time_: float, outputs: Callable[[], Vector], step: Step) -> None:
        if step.length == 0.0:
            self._began = time.process_time()

    def end(self, complete: bool, message: str) -> None:
        self.elapsed = time.process_time() - self._began
