"""Timing by paired repetition: all candidates in turn, several rounds, the median of each."""

import statistics
import time
from collections.abc import Callable, Mapping

from models.core.quantities import Vector
from models.core.system import System
from orchestrator.engine.observer import Observer
from orchestrator.engine.step import Step
from orchestrator.scenario import Scenario
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start


def measure_medians(candidates: Mapping[str, Callable[[], float]], rounds: int = 5) -> dict[str, float]:
    """The median figure of each candidate; each round runs all of them once, after one unmeasured round."""
    for candidate in candidates.values():
        candidate()
    figures: dict[str, list[float]] = {name: [] for name in candidates}
    for _ in range(rounds):
        for name, candidate in candidates.items():
            figures[name].append(candidate())
    return {name: statistics.median(found) for name, found in figures.items()}


def load_system(name: str) -> tuple[Scenario, System]:
    """A shipped scenario, and its system at its start."""
    scenario = load(name)
    return scenario, resolve_start(scenario, build_system(scenario))


class Clock(Observer):
    """An observer that takes the time of the stepping, `elapsed` (s): by default processor time, which other
    programs on the machine change less than wall time.
    """

    def __init__(self, timer: Callable[[], float] = time.process_time) -> None:
        self._timer = timer

    def observe(self, time_: float, outputs: Callable[[], Vector], step: Step) -> None:
        if step.length == 0.0:
            self._began = self._timer()

    def end(self, complete: bool, message: str) -> None:
        self.elapsed = self._timer() - self._began
