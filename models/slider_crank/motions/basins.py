"""Basins of attraction: which attractor a motion ends on, by its start."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...compile.parallel import each, no_progress
from ...core.quantities import Vector
from .machine import Machine, Motion
from .recurrence import run_until_recurrent

# Blocks of the last half of a motion without period, from whose scatter its means have their errors.
BLOCKS, LEAST = 20, 40
# Two motions without period are on one attractor if no mean differs by more standard errors than this: of
# 4 means of 1e5 starts, with errors from 20 blocks each, some 1e-3 differ by more by chance.
SAME = 8.0
# Means over an orbit, as parts of the gap and of ten times the gap, differ by rounding from start to start.
ROUNDING = 1e-7


class End(NamedTuple):
    """How a motion ends: its period (0: none was found) and means over its states at crank angle zero.

    means: of psi, psi', psi^2 and psi'^2, psi over gap and psi' over ten gaps; from wherever on an orbit they
    begin, they are the same. errors: their standard errors, 0 for an orbit.
    """

    period: int
    means: Vector
    errors: Vector


class Attractor(NamedTuple):
    """An attractor: its period, the largest exponent from the first start that ended on it, with standard
    error, and how many did."""

    period: int
    exponent: float
    uncertainty: float
    starts: int


class Basins(NamedTuple):
    """label (rates, psis): the place in `attractors`, which come in the order of their number of starts."""

    psi: Vector
    psi_rate: Vector
    label: NDArray[np.int_]
    attractors: tuple[Attractor, ...]


def find_basins(
    machine: Machine,
    psi: Vector,
    psi_rate: Vector,
    cycles: int = 2000,
    workers: int | None = None,
    progress: Callable[[int, int], None] = no_progress,
) -> Basins:
    """The attractors of all starts (psi, psi') at crank angle zero, each motion followed so many cycles at
    most. ValueError if a start is outside the walls or there are fewer than LEAST cycles."""
    if cycles < LEAST:
        raise ValueError(f"cycles = {cycles}: must be at least {LEAST}")
    for outermost in (float(np.min(psi)), float(np.max(psi))):
        Motion(machine, outermost)
    starts = [(float(a), float(b)) for b in psi_rate for a in psi]
    ends = each(lambda start: find_end(machine, start, cycles), starts, workers, progress)
    found: list[int] = []
    label = np.zeros(len(ends), dtype=int)
    for i, end in enumerate(ends):
        known = next((n for n, first in enumerate(found) if share_attractor(end, ends[first])), len(found))
        if known == len(found):
            found.append(i)
        label[i] = known
    counts = np.bincount(label)
    order = np.argsort(-counts, kind="stable")
    attractors = (
        Attractor(ends[found[n]].period, *exponent_at(machine, starts[found[n]], cycles), int(counts[n]))
        for n in order
    )
    places = np.argsort(order, kind="stable")[label].reshape(len(psi_rate), len(psi))
    return Basins(psi, psi_rate, places, tuple(attractors))


def find_end(machine: Machine, start: tuple[float, float], cycles: int) -> End:
    """How the motion from there ends."""
    states, found = run_until_recurrent(Motion(machine, *start), cycles)
    scaled = states[:, :2] / (machine.gap * np.array([1.0, 10.0]))
    squares = np.concatenate([scaled, scaled**2], axis=1)
    if found:
        return End(found.period, squares[-found.period :].mean(axis=0), np.zeros(4))
    means = np.array([block.mean(axis=0) for block in np.array_split(squares[len(squares) // 2 :], BLOCKS)])
    return End(0, means.mean(axis=0), means.std(axis=0, ddof=1) / math.sqrt(len(means)))


def share_attractor(end: End, other: End) -> bool:
    """True if two motions end on one attractor, within the errors of their means."""
    allowed = ROUNDING + SAME * np.hypot(end.errors, other.errors)
    return end.period == other.period and bool(np.all(np.abs(end.means - other.means) <= allowed))


def exponent_at(machine: Machine, start: tuple[float, float], cycles: int) -> tuple[float, float]:
    """Largest exponent and its standard error after so many cycles from there."""
    found = Motion(machine, *start).skip(cycles).exponents(cycles)
    return found.largest, found.uncertainty
