"""Forces of the walls on a roller that slides (F 2.6), over M l Omega^2."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

import numpy as np

from models.core.quantities import Vector
from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.motions.machine import Machine
from models.slider_crank.motions.regions import (
    TURN,
    Interval,
    force_zeros,
    holding_intervals,
    thresholds,
    wall_forces,
)


def compute_curve(machine: Machine, side: float, samples: int = 721) -> Vector:
    """The force over one revolution, both ends included."""
    return wall_forces(machine, side, np.linspace(0.0, TURN, samples))


def can_hold(machine: Machine, side: float, theta: float) -> bool:
    """True if that wall can hold the roller at this crank angle."""
    return bool(wall_forces(machine, side, np.array([theta]))[0] > 0.0)


@lru_cache(maxsize=256)
def find_changes(machine: Machine, side: float) -> tuple[float, ...]:
    """Crank angles in [0, 2 pi) at which the force is zero."""
    return tuple(float(angle) for angle in force_zeros(machine, side))


def find_pressed(machine: Machine, side: float) -> list[Interval]:
    """Where the roller may slide; an interval that passes 2 pi is given with a negative start."""
    found = [
        Interval(a - TURN, b - TURN) if b > TURN and a > 0.0 else Interval(a, b)
        for a, b in holding_intervals(machine, side)
    ]
    return sorted(found)


def measure_shares(machine: Machine) -> dict[str, float]:
    """Radians of crank in which the roller may slide on the upper wall only, lower only, both, neither."""
    edges = sorted({0.0, TURN, *find_changes(machine, UPPER), *find_changes(machine, LOWER)})
    found = {"upper": 0.0, "lower": 0.0, "both": 0.0, "neither": 0.0}
    for a, b in pairwise(edges):
        up, low = (can_hold(machine, side, 0.5 * (a + b)) for side in (UPPER, LOWER))
        found["both" if up and low else "upper" if up else "lower" if low else "neither"] += b - a
    return found


@lru_cache(maxsize=64)
def find_limits(form: str, gap: float = 0.0) -> tuple[float, float]:
    """lambda from which the upper wall holds throughout, and from which the lower one holds nowhere."""
    found = thresholds(Machine(gap=gap, form=form))
    return found.upper, found.lower
