"""Macro steps that keep a tolerance, between the steps whose errors are known."""

import itertools
import math
from collections.abc import Mapping

# Mantissas of advised steps.
ROUND = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)


def find_step_at_error(excess: Mapping[float, float], order: int, share: float) -> float:
    """Find the step at which the excess grows beyond `share`, by a power law between known steps.

    Below the first one the power is the method's order.
    """
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


def round_down(step: float) -> float:
    """Round down to a step with a short mantissa; zero for zero."""
    if not step > 0.0:
        return 0.0
    power = 10.0 ** math.floor(math.log10(step))
    return float(f"{max(m for m in ROUND if m * power <= step * (1.0 + 1e-12)) * power:.3g}")
