"""Timing by paired repetition: all candidates in turn, several rounds, the median of each."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Mapping


def medians(candidates: Mapping[str, Callable[[], float]], rounds: int = 5) -> dict[str, float]:
    """The median figure of each candidate; each round runs all of them once, after one unmeasured round."""
    for candidate in candidates.values():
        candidate()
    figures: dict[str, list[float]] = {name: [] for name in candidates}
    for _ in range(rounds):
        for name, candidate in candidates.items():
            figures[name].append(candidate())
    return {name: statistics.median(found) for name, found in figures.items()}
