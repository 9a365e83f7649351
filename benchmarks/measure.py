"""Timing by paired repetition: all candidates in turn, several rounds, the median of each."""

import statistics
from collections.abc import Callable, Mapping

from models.core.system import System
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
