"""The baseline of `slider_crank`, F appendix B compiled: Runge-Kutta 4 at 0.005 rad, bisected impacts."""

from __future__ import annotations

import math
from typing import Any

from models.compile.kernel import kernel
from models.slider_crank.equations import (
    Mechanism,
    flight_acceleration,
    rebound,
    wall_angle,
    wall_rate,
)

STEP = 0.005
# Halvings of the step that ends at a wall: to 1e-10 rad.
HALVINGS = 26


@kernel
def step(theta: float, h: float, psi: float, rate: float, m: Mechanism) -> tuple[float, float]:
    """One Runge-Kutta step of F (2.13)."""
    k1 = flight_acceleration(theta, 1.0, 0.0, psi, rate, m)
    p2, r2 = psi + 0.5 * h * rate, rate + 0.5 * h * k1
    k2 = flight_acceleration(theta + 0.5 * h, 1.0, 0.0, p2, r2, m)
    p3, r3 = psi + 0.5 * h * r2, rate + 0.5 * h * k2
    k3 = flight_acceleration(theta + 0.5 * h, 1.0, 0.0, p3, r3, m)
    p4, r4 = psi + h * r3, rate + h * k3
    k4 = flight_acceleration(theta + h, 1.0, 0.0, p4, r4, m)
    return (
        psi + h / 6.0 * (rate + 2.0 * r2 + 2.0 * r3 + r4),
        rate + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4),
    )


@kernel
def find_next_impact(theta: float, psi: float, rate: float, gap: float, m: Mechanism, end: float) -> Any:
    """(theta, psi, rate) just before the next impact, or at `end`."""
    while theta < end:
        h = min(STEP, end - theta)
        new_psi, new_rate = step(theta, h, psi, rate, m)
        if abs(new_psi) > wall_angle(theta + h, gap, m.xi):
            low, high = 0.0, h
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                new_psi, new_rate = step(theta, middle, psi, rate, m)
                if abs(new_psi) > wall_angle(theta + middle, gap, m.xi):
                    high = middle
                else:
                    low = middle
            new_psi, new_rate = step(theta, low, psi, rate, m)
            return theta + low, new_psi, new_rate
        theta, psi, rate = theta + h, new_psi, new_rate
    return theta, psi, rate


@kernel
def count_impacts(m: Mechanism, gap: float, restitution: float, cycles: int) -> tuple[int, float]:
    """Impacts over so many revolutions from psi = psi' = 0, and psi at the end."""
    psi = rate = 0.0
    impacts = 0
    for _ in range(cycles):
        theta = 0.0
        while True:
            theta, psi, rate = find_next_impact(theta, psi, rate, gap, m, 2.0 * math.pi)
            if theta >= 2.0 * math.pi:
                break
            wall = wall_angle(theta, math.copysign(gap, psi), m.xi)
            rate = rebound(rate, wall_rate(theta, 1.0, wall, m.xi), restitution)
            impacts += 1
    return impacts, psi
