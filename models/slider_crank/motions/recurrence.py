"""Periodicity of a motion from its states at crank angle zero (the stroboscopic map)."""

from typing import NamedTuple, Protocol

import numpy as np

from ...core.quantities import Vector

# Of the largest psi and psi'. On stable orbits rounding makes differences of up to 2e-13, far below. Chaos of
# correlation dimension D comes so near to a given state by chance once in 1e9^D cycles, and does not stay for
# REPEATS periods.
TOLERANCE = 1e-9
# A motion is settled on its orbit where it stays for good within this part of the largest psi and psi': a
# line's width in a figure.
SETTLED = 1e-3
# Periods in succession that make a recurrence. A state that comes back to the last bit needs only one: the
# same state has the same future.
REPEATS = 20
# Near returns to try as a period before a motion counts as not recurrent.
TRIES = 64
# Revolutions before the first look for a period; each further look has twice as many.
FIRST_LOOK = 256


class Recurrence(NamedTuple):
    """A motion that repeats every `period` cycles.

    repeats: periods in succession, up to the last state, within TOLERANCE. distance: the largest difference
    of states one period apart over the last REPEATS periods (fewer if `exact`), as part of the largest psi
    and psi'. transient: cycles until the motion is settled on the orbit. exact: it repeats to the last bit.
    """

    period: int
    repeats: int
    distance: float
    transient: int
    exact: bool


class StroboscopicMotion(Protocol):
    """A motion with states (cycles, 3) of psi, psi' and sliding side, one a revolution."""

    def strobe(self, cycles: int) -> Vector: ...


def find_recurrence(states: Vector) -> Recurrence | None:
    """The smallest period with which states (cycles, 3: psi, psi', side) repeat at their end, or None."""
    last = len(states) - 1
    scale = scales(states)
    near = last - np.flatnonzero(distances(states[:-1], states[-1:], scale) <= TOLERANCE)[::-1]
    exact = last - np.flatnonzero((states[:-1] == states[-1]).all(axis=1))[::-1]
    for period in near[near * REPEATS <= last][:TRIES]:
        end = states[-1 - REPEATS * period :]
        distance = float(distances(end[period:], end[:-period], scale).max())
        if distance <= TOLERANCE:
            return _build_recurrence(states, int(period), distance, scale, period in exact)
    if not exact.size:
        return None
    return _build_recurrence(states, _find_smallest_period(states, int(exact[0]), scale), 0.0, scale, True)


def run_until_recurrent(motion: StroboscopicMotion, cycles: int) -> tuple[Vector, Recurrence | None]:
    """States of a motion until a period is found, or over so many cycles, and the recurrence."""
    states = motion.strobe(min(FIRST_LOOK, cycles))
    while (found := find_recurrence(states)) is None and len(states) < cycles:
        states = np.concatenate([states, motion.strobe(min(len(states), cycles - len(states)))])
    return states, found


def scales(states: Vector) -> Vector:
    """Scales of differences of states: the largest psi and psi'; next to zero for the side."""
    largest = np.abs(states[:, :2]).max(axis=0)
    return np.append(np.where(largest > 0.0, largest, 1.0), np.finfo(float).tiny)


def distances(states: Vector, others: Vector, scale: Vector) -> Vector:
    """The larger relative difference in psi and psi', infinite where one slides and the other does not."""
    with np.errstate(over="ignore"):
        return (np.abs(states - others) / scale).max(axis=1)


def _find_smallest_period(states: Vector, exact: int, scale: Vector) -> int:
    """The smallest part of an exact period that is one within TOLERANCE: rounding, carried round a stable
    orbit, may repeat after several periods only."""
    orbit = states[-exact:]
    parts = (part for part in range(1, exact) if exact % part == 0)
    repeats = (part for part in parts if distances(orbit, np.roll(orbit, part, 0), scale).max() <= TOLERANCE)
    return next(repeats, exact)


def _build_recurrence(states: Vector, period: int, distance: float, scale: Vector, exact: bool) -> Recurrence:
    """How long the last `period` states have been the motion's orbit."""
    back = np.arange(len(states))[::-1]
    away = distances(states, states[-1 - back % period], scale)
    return Recurrence(
        period,
        _count_within(away, TOLERANCE) // period,
        distance,
        len(away) - _count_within(away, SETTLED),
        exact,
    )


def _count_within(away: Vector, tolerance: float) -> int:
    """Elements at the end that stay within the tolerance."""
    outside = np.flatnonzero(away > tolerance)
    return len(away) - (int(outside[-1]) + 1 if outside.size else 0)
