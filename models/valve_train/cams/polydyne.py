"""Polydyne cams: a lift that moves the valve of an elastic train as a law wants it, at one speed.

One mass m on a link of stiffness k_l, closed by a spring of rate k_s and preload F_0 (Dudley 1948;
Stoddart 1953):
y_c = F_0/k_l + (1 + k_s/k_l) y + (m Omega^2/k_l) y''.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from .law import law_lift
from .smoothing import interpolate_lift
from .table import Points

POINTS = 720


@dataclass(frozen=True)
class Train:
    """Mass (kg) at the valve, stiffness of the link and rate of the spring (N/m), preload (N)."""

    mass: float
    link_stiffness: float
    spring_rate: float
    preload: float

    def deflect(self, lift: float, curvature: float, speed: float) -> float:
        """y_c - F_0/k_l (m) for the valve's lift (m), y'' (m/rad^2) and the cam's speed (rad/s)."""
        stiffness = self.link_stiffness
        return (1.0 + self.spring_rate / stiffness) * lift + self.mass * speed**2 / stiffness * curvature


def polydyne_lift(p: Any, train: Train, speed: float) -> Points:
    """The cam's lift for the valve to follow the law in the record `p` at `speed` (rad/s of the cam).

    The ramps of `p` get the height F_0/k_l, by which the link shortens under the preload. The lift is exact
    at its points.
    """
    angles = 2.0 * math.pi * np.arange(POINTS) / POINTS
    ramp, valve = p.copy(), p.copy()
    valve.ramp_height, ramp.ramp_height = 0.0, train.preload / train.link_stiffness
    lifts = []
    for angle in angles:
        wished, ramped = law_lift(angle, valve), law_lift(angle, ramp)
        lifts.append(train.deflect(wished.s, wished.dds, speed) + (ramped.s - wished.s))
    return interpolate_lift(angles, np.array(lifts))
