"""Bouncing motions with closed forms: the harmonic impact oscillator and the bouncing ball."""

import math
from typing import NamedTuple

import numpy as np

from models.core.quantities import Vector
from models.slider_crank.flight.bouncing import POSITION_SIZE, SCRATCH_ROWS, Walls
from models.slider_crank.flight.flow import (
    COLUMNS,
    DAMPING,
    FORCING,
    PRESSING_LOWER,
    PRESSING_UPPER,
    STIFFNESS,
    Flow,
    tabulate_flow,
)
from models.slider_crank.flight.series import TERMS

FAR = 10.0


def flow_of(forcing, stiffness=0.0, damping=0.0, upper=0.0, lower=FAR) -> Flow:
    """y'' = forcing(theta) + stiffness y + damping y', constant coefficients."""

    def sample(cells: int) -> Vector:
        samples = np.zeros((cells, COLUMNS))
        r = forcing(2.0 * math.pi / cells * np.arange(cells))
        samples[:, FORCING], samples[:, STIFFNESS], samples[:, DAMPING] = r, stiffness, damping
        samples[:, PRESSING_UPPER] = r + stiffness * upper
        samples[:, PRESSING_LOWER] = -r + stiffness * lower
        return samples

    return tabulate_flow(sample)


class Orbit(NamedTuple):
    """One impact per period of x'' + x = cos(omega t), x <= sigma, x' -> -r x'.

    `velocity` before the impact and `phase` omega t at it; `trace` of its multipliers, determinant r^2.
    """

    velocity: float
    phase: float
    trace: float


def impact_oscillator_orbit(omega: float, r: float, sigma: float, sign: float) -> Orbit:
    """The two orbits (sign -1, +1) with period 2 pi / omega, from the closed form."""
    gamma = 1.0 / (1.0 - omega**2)
    period = 2.0 * math.pi / omega
    t = math.tan(period / 2.0)
    ratio = t * (1.0 - r) / ((1.0 + r) * omega)
    # (sigma - A)^2 + (A ratio)^2 = gamma^2
    a, b, c = 1.0 + ratio**2, -2.0 * sigma, sigma**2 - gamma**2
    amplitude = (-b + sign * math.sqrt(b * b - 4.0 * a * c)) / (2.0 * a)
    velocity = -2.0 * amplitude * t / (1.0 + r)
    phase = math.atan2((amplitude * t + r * velocity) / (gamma * omega), (sigma - amplitude) / gamma)
    before = math.cos(phase) - sigma
    trace = -2.0 * r * math.cos(period) + (1.0 + r) * before / velocity * math.sin(period)
    return Orbit(velocity, phase % (2.0 * math.pi), trace)


def impact_oscillator(omega: float, r: float, sigma: float) -> tuple[Flow, Walls]:
    """The oscillator in the phase omega t."""
    flow = flow_of(lambda phase: np.cos(phase) / omega**2, -1.0 / omega**2, upper=sigma)
    return flow, Walls(sigma, FAR, r, 0.0)


def position_at(flow: Flow, phase: float, y: float, rate: float) -> Vector:
    """A position in flight."""
    place = phase * flow.cells.shape[0] / (2.0 * math.pi)
    position = np.zeros(POSITION_SIZE)
    position[:4] = int(place), place - int(place), y, rate
    return position


def scratch() -> Vector:
    return np.zeros((SCRATCH_ROWS, TERMS))
