"""Farahanchi 1991 (F), chapter 2: motion of a connecting rod whose slider has clearance, linear in psi.

psi is the deviation of the rod from its nominal angle phi, sin phi = xi sin theta; the rod's angle is
phi - psi. F uses phi' + psi' for its rotation, so that beta enters the forcing with the wrong sign
(`as_published`); derived from the rod's angle it is +beta (`corrected`).

Moments are divided by M l^2, forces by M l. With speed 1, no acceleration and damping lambda the
equations are F's dimensionless ones, per radian of crank; with a speed in rad/s and damping
c2 / (M l^2) they are the same in seconds, for varying speed too, and nothing is divided by the speed.
"""

import math
from typing import NamedTuple

from ..compile.kernel import kernel


class Mechanism(NamedTuple):
    """F section 2.3. `forcing_beta` is the beta in the forcing: beta (corrected), -beta (as published)."""

    xi: float  # crank radius / rod length
    alpha: float  # rod mass / piston mass
    beta: float  # rod inertia / (piston mass * rod length^2)
    forcing_beta: float
    damping: float  # c2 / (M l^2): F's lambda at unit speed


class Crank(NamedTuple):
    """The crank at an instant."""

    theta: float
    speed: float
    acceleration: float


# F section 4.1.
THESIS_XI, THESIS_ALPHA, THESIS_BETA = 0.3030, 1.9000, 0.4719


def thesis_mechanism(damping: float, corrected: bool = False) -> Mechanism:
    """F's engine with friction parameter lambda = `damping`, as published unless `corrected`."""
    sign = 1.0 if corrected else -1.0
    return Mechanism(THESIS_XI, THESIS_ALPHA, THESIS_BETA, sign * THESIS_BETA, damping)


@kernel
def rod_cosine(theta: float, xi: float) -> float:
    """Lambda = cos phi = sqrt(1 - xi^2 sin^2 theta)."""
    return math.sqrt(1.0 - (xi * math.sin(theta)) ** 2)


@kernel
def rod_slope(theta: float, xi: float) -> float:
    """d phi / d theta = xi cos theta / Lambda."""
    return xi * math.cos(theta) / rod_cosine(theta, xi)


@kernel
def rod_curvature(theta: float, xi: float) -> float:
    """d^2 phi / d theta^2 = (xi^3 - xi) sin theta / Lambda^3."""
    return (xi**3 - xi) * math.sin(theta) / rod_cosine(theta, xi) ** 3


@kernel
def sine_of_sum(theta: float, xi: float) -> float:
    """sin(theta + phi)."""
    return math.sin(theta) * rod_cosine(theta, xi) + 0.5 * xi * math.sin(2.0 * theta)


@kernel
def cosine_of_sum(theta: float, xi: float) -> float:
    """cos(theta + phi)."""
    return math.cos(theta) * rod_cosine(theta, xi) - xi * math.sin(theta) ** 2


@kernel
def inertia(m: Mechanism) -> float:
    """a of F (2.13)."""
    return m.alpha / 4.0 + 1.0 + m.beta


@kernel
def coupling(m: Mechanism) -> float:
    """(1 + alpha/2) xi: strength of the crank pin's motion."""
    return (1.0 + m.alpha / 2.0) * m.xi


@kernel
def stiffness(theta: float, m: Mechanism) -> float:
    """c(theta) of F (2.13)."""
    return coupling(m) * cosine_of_sum(theta, m.xi)


@kernel
def forcing(theta: float, m: Mechanism) -> float:
    """f(theta) of F (2.13) without its terms in lambda."""
    return forcing_inertia(m) * rod_curvature(theta, m.xi) + coupling(m) * sine_of_sum(theta, m.xi)


@kernel
def forcing_inertia(m: Mechanism) -> float:
    """alpha/4 + 1 + beta, or - beta as published: what the nominal rod's rotation carries."""
    return m.alpha / 4.0 + 1.0 + m.forcing_beta


@kernel
def speed_up_forcing(theta: float, m: Mechanism) -> float:
    """The moment per crank acceleration at psi = 0 (F: constant speed)."""
    return forcing_inertia(m) * rod_slope(theta, m.xi) - coupling(m) * cosine_of_sum(theta, m.xi)


@kernel
def speed_up_stiffness(theta: float, m: Mechanism) -> float:
    """The restoring moment per crank acceleration and psi (F: constant speed)."""
    return coupling(m) * sine_of_sum(theta, m.xi)


@kernel
def joint_rate(theta: float, speed: float, rate: float, m: Mechanism) -> float:
    """Rate of the crank relative to the rod, theta' + phi' - psi' (F 2.6)."""
    return speed * (1.0 + rod_slope(theta, m.xi)) - rate


@kernel
def free_moment(at: Crank, psi: float, rate: float, m: Mechanism) -> float:
    """What turns the rod when no wall touches: f - lambda psi' - c psi of F (2.13)."""
    theta, speed, acceleration = at
    return (
        speed**2 * (forcing(theta, m) - stiffness(theta, m) * psi)
        + acceleration * (speed_up_forcing(theta, m) - speed_up_stiffness(theta, m) * psi)
        + m.damping * joint_rate(theta, speed, rate, m)
    )


@kernel
def flight_acceleration(at: Crank, psi: float, rate: float, m: Mechanism) -> float:
    """psi'' in free flight, F (2.13)."""
    return free_moment(at, psi, rate, m) / inertia(m)


@kernel
def narrowing(theta: float, xi: float) -> float:
    """d ln Lambda / d theta = -xi^2 sin theta cos theta / Lambda^2."""
    return -0.5 * xi**2 * math.sin(2.0 * theta) / rod_cosine(theta, xi) ** 2


@kernel
def narrowing_slope(theta: float, xi: float) -> float:
    """d^2 ln Lambda / d theta^2."""
    first = narrowing(theta, xi)
    return -(xi**2) * math.cos(2.0 * theta) / rod_cosine(theta, xi) ** 2 - 2.0 * first**2


@kernel
def wall_angle(theta: float, gap: float, xi: float) -> float:
    """psi at which the slider is `gap` (in rod lengths) off centre, F (2.14), (2.15)."""
    return gap / rod_cosine(theta, xi)


@kernel
def wall_rate(theta: float, speed: float, psi: float, xi: float) -> float:
    """psi' of a slider that keeps its distance from the centre line."""
    return -narrowing(theta, xi) * speed * psi


@kernel
def wall_acceleration(at: Crank, psi: float, xi: float) -> float:
    """psi'' of a slider that keeps its distance from the centre line."""
    theta, speed, acceleration = at
    first = narrowing(theta, xi)
    return psi * (speed**2 * (first**2 - narrowing_slope(theta, xi)) - acceleration * first)


@kernel
def rebound(rate: float, rate_of_wall: float, restitution: float) -> float:
    """psi' after an impact: the velocity relative to the wall times -e, F (2.16), (2.17)."""
    return rate_of_wall - restitution * (rate - rate_of_wall)
