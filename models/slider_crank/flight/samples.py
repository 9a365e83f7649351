"""Samples of the equation of motion in y at unit speed, from which its `flow` is tabulated."""

import math

from ...compile.kernel import kernel
from ...core.quantities import Vector
from ..equations import Crank, Mechanism, flight_acceleration, inertia, narrowing, narrowing_slope, rod_cosine
from ..forms import NONLINEAR, constraint_force, offset_slope, wall_angle
from .flow import DAMPING, FORCING, PRESSING_LOWER, PRESSING_UPPER, STIFFNESS


@kernel
def offset_acceleration(theta: float, y: float, rate: float, m: Mechanism) -> float:
    """y'' of y = Lambda psi in free flight of the linear forms, per radian squared."""
    cosine, first = rod_cosine(theta, m.xi), narrowing(theta, m.xi)
    psi = y / cosine
    psi_rate = rate / cosine - first * psi
    bend = flight_acceleration(Crank(theta, 1.0, 0.0), psi, psi_rate, m)
    return cosine * (bend + 2.0 * first * psi_rate + (narrowing_slope(theta, m.xi) + first**2) * psi)


@kernel
def sample_flow(m: Mechanism, samples: Vector) -> None:
    """Samples of r, q and d of the linear forms."""
    for i in range(samples.shape[0]):
        theta = 2.0 * math.pi * i / samples.shape[0]
        r = offset_acceleration(theta, 0.0, 0.0, m)
        samples[i, FORCING] = r
        samples[i, STIFFNESS] = offset_acceleration(theta, 1.0, 0.0, m) - r
        samples[i, DAMPING] = offset_acceleration(theta, 0.0, 1.0, m) - r


@kernel
def sample_pressing(form: float, m: Mechanism, gap: float, samples: Vector) -> None:
    """Samples of the accelerations towards the walls, from the constraint forces.

    Of the nonlinear form also its damping, so that the cells are short enough for it.
    """
    for i in range(samples.shape[0]):
        theta = 2.0 * math.pi * i / samples.shape[0]
        samples[i, PRESSING_UPPER] = pressing(form, 1.0, theta, gap, m)
        samples[i, PRESSING_LOWER] = pressing(form, -1.0, theta, gap, m)
        if form == NONLINEAR:
            samples[i, DAMPING] = -m.damping / inertia(m)


@kernel
def pressing(form: float, side: float, theta: float, gap: float, m: Mechanism) -> float:
    """Acceleration in y towards the wall on that side of a slider that rests on it: F dy/dpsi^2 / a."""
    psi = wall_angle(form, theta, side * gap, m)
    force = constraint_force(form, Crank(theta, 1.0, 0.0), psi, m)
    return side * force * offset_slope(form, theta, psi, m) ** 2 / inertia(m)
