"""How long chaos lasts before a motion settles on a periodic orbit, over many starts."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...compile.parallel import each, no_progress
from ...core.quantities import Vector
from .machine import Machine, Motion
from .recurrence import run_until_recurrent

# F appendix B lets 30 cycles pass before it records anything.
ORDINARY_TRANSIENT = 30


@dataclass(frozen=True)
class Transients:
    """Transients of many starts.

    starts: (n, 2) psi, psi' at crank angle zero. lengths: cycles until settled, `cycles` where the motion did
    not settle within them. periods: of the orbits, 0 where there is none.
    """

    starts: Vector
    lengths: Vector
    periods: Vector
    cycles: int

    @property
    def settled(self) -> Any:
        """True where the motion settled."""
        return self.periods > 0


@dataclass(frozen=True)
class EscapeTime:
    """The fit P(length > t) = exp(-(t - t0)/mean) to the lengths above t0 = ORDINARY_TRANSIENT, in cycles.

    error: standard error of the mean. distance: largest difference between fit and sample distribution (of
    Kolmogorov and Smirnov) among the motions that settled; about 1/sqrt(escapes) or less if the fit is good.
    """

    mean: float
    error: float
    escapes: int
    distance: float


def measure_transients(
    machine: Machine,
    starts: Vector,
    cycles: int = 10_000,
    progress: Callable[[int, int], None] = no_progress,
) -> Transients:
    """Transients from (n, 2) starts psi, psi' at crank angle zero, each looked at for so many cycles."""

    def settle(start: tuple[float, float]) -> tuple[int, int]:
        found = run_until_recurrent(Motion(machine, *start), cycles)[1]
        return (found.transient, found.period) if found else (cycles, 0)

    found = np.array(each(settle, [(float(psi), float(rate)) for psi, rate in starts], None, progress))
    return Transients(starts, found[:, 0], found[:, 1], cycles)


def draw_starts(machine: Machine, count: int, seed: int = 0) -> Vector:
    """Uniform between the walls, and in psi' up to what crosses the gap in a tenth of a radian."""
    unit = np.random.default_rng(seed).uniform(-1.0, 1.0, (count, 2))
    return unit * machine.gap * np.array([1.0, 10.0])


def fit_escape_time(found: Transients) -> EscapeTime | None:
    """Most likely mean of the exponential distribution; None if none escaped.

    Motions that did not settle count with the time for which they were seen. mean = total time / escapes,
    error = mean / sqrt(escapes).
    """
    longer = found.lengths > ORDINARY_TRANSIENT
    times = found.lengths[longer] - ORDINARY_TRANSIENT
    escapes = int(np.count_nonzero(found.settled[longer]))
    if escapes == 0:
        return None
    mean = float(times.sum() / escapes)
    seen = np.sort(times[found.settled[longer]])
    ranks = np.arange(1, len(seen) + 1) / len(times)
    fit = -np.expm1(-seen / mean)
    distance = float(max(np.abs(ranks - fit).max(), np.abs(ranks - 1.0 / len(times) - fit).max()))
    return EscapeTime(mean, mean / math.sqrt(escapes), escapes, distance)
