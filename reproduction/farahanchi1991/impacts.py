"""Numbers of a record of impacts."""

from __future__ import annotations

import numpy as np

from models.core.quantities import Vector
from models.slider_crank.equations import THESIS_XI
from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.machine import Events, Machine
from models.slider_crank.motions.statistics import energies, impact_profile, uniformity, wall_position

__all__ = [
    "LOWER",
    "UPPER",
    "energy",
    "location",
    "mean_approach",
    "on_wall",
    "profile",
    "severity",
    "spread",
]
BINS = 50


def on_wall(events: Events, side: float) -> Events:
    """The impacts on that wall."""
    impacts = events.impacts
    return impacts.where(impacts.side == side)


def location(theta: Vector) -> Vector:
    """x of F 3.2: the piston's place on the wall, in rod lengths from the crank's centre."""
    return wall_position(theta, THESIS_XI)


def mean_approach(events: Events) -> float:
    """Mean velocity of approach, over l Omega; 0 without impacts."""
    return float(events.approach.mean()) if len(events.approach) else 0.0


def severity(events: Events, cycles: int) -> float:
    """Sum of the velocities of approach per cycle: has a limit where bounces accumulate, unlike the mean."""
    return float(events.approach.sum()) / cycles


def energy(machine: Machine, events: Events, cycles: int) -> float:
    """What the impacts take per cycle, over M l^2 Omega^2."""
    return float(energies(machine, events.impacts).sum()) / cycles


def profile(events: Events, side: float, cycles: int, bins: int = BINS) -> Vector:
    """Velocities of approach per cycle in equal parts of one wall."""
    impacts = events.impacts
    found = impact_profile(impacts, impacts.approach, THESIS_XI, bins, cycles)
    return found.upper if side == UPPER else found.lower


def spread(events: Events) -> float:
    """Uniformity of the velocities of approach along the walls, their mean weighed by the walls' shares of
    it: 1 even, 0 in one spot, nan without impacts."""
    walls = [profile(events, side, 1) for side in (UPPER, LOWER)]
    used = [wall for wall in walls if wall.sum() > 0.0]
    if not used:
        return float("nan")
    return float(np.average([uniformity(wall) for wall in used], weights=[wall.sum() for wall in used]))
