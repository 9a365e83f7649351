"""Numbers of a record of impacts."""

from __future__ import annotations

import numpy as np

from models.core.quantities import Vector
from models.slider_crank.equations import THESIS_XI
from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.motions.machine import Events
from models.slider_crank.motions.statistics import impact_profile, uniformity

BINS = 50


def select_wall(events: Events, side: float) -> Events:
    """The impacts on that wall."""
    impacts = events.impacts
    return impacts.where(impacts.side == side)


def average_approach(events: Events) -> float:
    """Mean velocity of approach, over l Omega; 0 without impacts."""
    return float(events.approach.mean()) if len(events.approach) else 0.0


def compute_profile(events: Events, side: float, cycles: int, bins: int = BINS) -> Vector:
    """Velocities of approach per cycle in equal parts of one wall."""
    impacts = events.impacts
    found = impact_profile(impacts, impacts.approach, THESIS_XI, bins, cycles)
    return found.upper if side == UPPER else found.lower


def measure_spread(events: Events) -> float:
    """Uniformity of the velocities of approach along the walls, their mean weighed by the walls' shares of
    it: 1 even, 0 in one spot, nan without impacts."""
    walls = [compute_profile(events, side, 1) for side in (UPPER, LOWER)]
    used = [wall for wall in walls if wall.sum() > 0.0]
    if not used:
        return float("nan")
    return float(np.average([uniformity(wall) for wall in used], weights=[wall.sum() for wall in used]))
