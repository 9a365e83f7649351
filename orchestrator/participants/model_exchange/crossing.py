"""Indicators that are exactly zero where their event is located.

The event is a change of the domain, from z <= 0 to z > 0 or back (FMI 2.0, 3.1). At zero an FMU may see
either, and one that sees no change would have the same event again, without end.
"""

import math

import numpy as np

from models.core.quantities import Vector
from models.monolithic.problem import TIME_EVENT, Problem

# How far behind an event its guard has to be below zero, relative to the time, or in s before 1 s.
SOON = 1e-9


def cross(problem: Problem, guard: int, t: float, z: Vector) -> float:
    """Move z along its rate to where the guard is below zero; the time of that, just behind t.

    If the guard is below zero at t, or not soon after, t and z stay as they are.
    """
    if guard == TIME_EVENT or problem.guards(t, z)[guard] < 0.0:
        return t
    begin, rate = z.copy(), problem.rate(t, z).copy()
    step = math.ulp(max(abs(t), SOON))
    while step < SOON * max(abs(t), 1.0):
        z[:] = begin + step * rate
        if problem.guards(t + step, z)[guard] < 0.0:
            return t + step
        step *= 2.0
    z[:] = begin
    return t


def leave_zeros(problem: Problem, t: float, z: Vector) -> float:
    """As `cross`, of the first guard that is exactly zero and falls at once."""
    for guard in np.flatnonzero(problem.guards(t, z) == 0.0):
        if (behind := cross(problem, int(guard), t, z)) > t:
            return behind
    return t
