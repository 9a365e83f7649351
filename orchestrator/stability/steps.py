"""Steps that are advised: where an error reaches its bound, and what one writes down."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping

# Mantissas of recommended steps.
ROUND = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)


def reached(excess: Mapping[float, float], order: int, share: float) -> float:
    """The step at which the excess grows beyond `share`: between known steps a power law, below the first
    one that of the method's order."""
    steps = list(excess)
    if not steps or not math.isfinite(excess[steps[0]]):
        return 0.0
    if excess[steps[0]] > share:
        return float(steps[0] * (share / excess[steps[0]]) ** (1.0 / order))
    for low, high in itertools.pairwise(steps):
        if not excess[high] <= share:
            if not math.isfinite(excess[high]) or excess[low] <= 0.0:
                return low
            slope = math.log(high / low) / math.log(excess[high] / excess[low])
            return float(low * (share / excess[low]) ** slope)
    return steps[-1]


def rounded_down(step: float) -> float:
    """The next smaller step that one would write down; zero for zero."""
    if not step > 0.0:
        return 0.0
    power = 10.0 ** math.floor(math.log10(step))
    return float(f"{max(m for m in ROUND if m * power <= step * (1.0 + 1e-12)) * power:.3g}")
