"""The mechanism without the small-angle step: exact walls, any crank speed (form `nonlinear`).

eta = phi - psi is the rod's angle below the cylinder's axis, sin phi = xi sin theta. Over M l^2

    T = (1+alpha) xi^2 theta'^2/2 + a eta'^2/2 - k theta' eta' cos(theta+eta),    k = (1+alpha/2) xi,

and with the joint's friction lambda (theta' + eta') and the upper wall's force F (downwards, over M l)

    a eta'' = k theta'' cos(theta+eta) - k theta'^2 sin(theta+eta) - lambda (theta'+eta') + F cos eta.

The slider is y/l = sin phi - sin eta above the axis. Written for psi, as `equations` are. At constant
speed sigma = theta + eta swings as a damped pendulum in free flight: a sigma'' + lambda sigma' + k sin
sigma = 0 per radian of crank.
"""

import math

from ..compile.kernel import kernel
from .equations import Crank, Mechanism, coupling, inertia, joint_rate, rod_cosine, rod_curvature, rod_slope


@kernel
def rod_angle(theta: float, psi: float, xi: float) -> float:
    """eta."""
    return math.asin(xi * math.sin(theta)) - psi


@kernel
def rod_rate(theta: float, speed: float, rate: float, xi: float) -> float:
    """eta'."""
    return rod_slope(theta, xi) * speed - rate


@kernel
def free_moment(at: Crank, psi: float, rate: float, m: Mechanism) -> float:
    """a psi'' when no wall touches."""
    theta, speed, acceleration = at
    sigma = theta + rod_angle(theta, psi, m.xi)
    nominal = rod_slope(theta, m.xi) * acceleration + rod_curvature(theta, m.xi) * speed**2
    pin = acceleration * math.cos(sigma) - speed**2 * math.sin(sigma)
    return inertia(m) * nominal - coupling(m) * pin + m.damping * joint_rate(theta, speed, rate, m)


@kernel
def offset(theta: float, psi: float, xi: float) -> float:
    """y/l = sin phi - sin eta, without their cancellation."""
    phi = math.asin(xi * math.sin(theta))
    return 2.0 * math.cos(phi - 0.5 * psi) * math.sin(0.5 * psi)


@kernel
def offset_slope(theta: float, psi: float, xi: float) -> float:
    """d(y/l)/d psi = cos eta."""
    return math.cos(rod_angle(theta, psi, xi))


@kernel
def offset_bend(theta: float, psi: float, xi: float) -> float:
    """d^2(y/l)/d psi^2 = sin eta."""
    return math.sin(rod_angle(theta, psi, xi))


@kernel
def wall_angle(theta: float, gap: float, xi: float) -> float:
    """psi at y/l = gap: sin eta = sin phi - gap, so that tan(psi/2) = gap / (cos phi + cos eta)."""
    cosine = math.sqrt(1.0 - (xi * math.sin(theta) - gap) ** 2)
    return 2.0 * math.atan(gap / (rod_cosine(theta, xi) + cosine))


@kernel
def wall_rate(theta: float, speed: float, psi: float, xi: float) -> float:
    """psi' of a slider that keeps its y: cos eta eta' = cos phi phi' = xi cos theta theta'."""
    phi = math.asin(xi * math.sin(theta))
    difference = 2.0 * math.sin(phi - 0.5 * psi) * math.sin(0.5 * psi)  # cos eta - cos phi
    return rod_slope(theta, xi) * speed * difference / math.cos(phi - psi)


@kernel
def wall_rate_slope(theta: float, speed: float, psi: float, xi: float) -> float:
    """d(wall_rate)/d psi."""
    eta = rod_angle(theta, psi, xi)
    return xi * math.cos(theta) * speed * math.sin(eta) / math.cos(eta) ** 2


@kernel
def wall_acceleration(at: Crank, psi: float, xi: float) -> float:
    """psi'' of a slider that keeps its y, from (sin phi)'' = (sin eta)''."""
    theta, speed, acceleration = at
    eta = rod_angle(theta, psi, xi)
    eta_rate = rod_rate(theta, speed, wall_rate(theta, speed, psi, xi), xi)
    pin = xi * (math.cos(theta) * acceleration - math.sin(theta) * speed**2)
    nominal = rod_slope(theta, xi) * acceleration + rod_curvature(theta, xi) * speed**2
    return nominal - (pin + math.sin(eta) * eta_rate**2) / math.cos(eta)


@kernel
def kinetic_energy(theta: float, speed: float, psi: float, rate: float, m: Mechanism) -> float:
    """T."""
    eta_rate = rod_rate(theta, speed, rate, m.xi)
    sigma = theta + rod_angle(theta, psi, m.xi)
    return (
        0.5 * (1.0 + m.alpha) * (m.xi * speed) ** 2
        + 0.5 * inertia(m) * eta_rate**2
        - coupling(m) * speed * eta_rate * math.cos(sigma)
    )


@kernel
def crank_torque(
    at: Crank, psi: float, rate: float, rate_change: float, wall_force: float, m: Mechanism
) -> float:
    """Torque that the mechanism takes from the crank (over M l^2); `rate_change` is psi''.

    (1+alpha) xi^2 theta'' - k eta'' cos(theta+eta) + k eta'^2 sin(theta+eta) + lambda (theta'+eta')
    + F xi cos theta: the Lagrange equation for theta at fixed eta.
    """
    theta, speed, acceleration = at
    sigma = theta + rod_angle(theta, psi, m.xi)
    eta_rate = rod_rate(theta, speed, rate, m.xi)
    nominal = rod_slope(theta, m.xi) * acceleration + rod_curvature(theta, m.xi) * speed**2
    pin = eta_rate**2 * math.sin(sigma) - (nominal - rate_change) * math.cos(sigma)
    return (
        (1.0 + m.alpha) * m.xi**2 * acceleration
        + coupling(m) * pin
        + m.damping * joint_rate(theta, speed, rate, m)
        + wall_force * m.xi * math.cos(theta)
    )


@kernel
def crank_impulse(theta: float, psi: float, rate_jump: float, m: Mechanism) -> float:
    """Angular impulse taken from the crank (over M l^2) by an impact that changes psi' by `rate_jump`.

    At a crank of given speed: k jump cos(theta+eta), and the reaction of the wall's impulse
    -a jump / cos eta.
    """
    eta = rod_angle(theta, psi, m.xi)
    reaction = -inertia(m) * rate_jump / math.cos(eta) * m.xi * math.cos(theta)
    return coupling(m) * rate_jump * math.cos(theta + eta) + reaction
