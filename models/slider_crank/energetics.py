"""Kinetic energy and crank torque of the linear equation of motion.

In the two coordinates theta (crank) and psi the exact kinetic energy over M l^2 is

    T = A theta'^2/2 + B theta' psi' + a psi'^2/2,
    A = (1+alpha) xi^2 + a phi1^2 - 2 k cos(theta+phi-psi) phi1,    k = (1+alpha/2) xi,
    B = -a phi1 + k cos(theta+phi-psi),                             phi1 = d phi/d theta.

Its expansion to second order in (psi, psi') - A to psi^2, B to psi - has exactly the linear equation
of `equations` as its Lagrange equation for psi. The torque here is the Lagrange equation of the same
expansion for theta, so that power and energy balance exactly in the linear model, also for varying
speed; against the exact mechanism the energy is in error by O(3) in (psi, psi') and the torque by
O(2). F's error is a term of B (its phi' + psi'), so `as_published` balances with its own energy.
"""

from ..compile.kernel import kernel
from . import equations as eq
from .equations import Crank, Mechanism


@kernel
def crank_inertia(theta: float, psi: float, m: Mechanism) -> float:
    """A: inertia of the mechanism seen by the crank."""
    slope = eq.rod_slope(theta, m.xi)
    cosine, sine = eq.cosine_of_sum(theta, m.xi), eq.sine_of_sum(theta, m.xi)
    turned = cosine * (1.0 - 0.5 * psi**2) + sine * psi
    return (1.0 + m.alpha) * m.xi**2 + eq.inertia(m) * slope**2 - 2.0 * eq.coupling(m) * turned * slope


@kernel
def mixed_inertia(theta: float, psi: float, m: Mechanism) -> float:
    """B: inertia that couples crank and psi."""
    turned = eq.cosine_of_sum(theta, m.xi) + eq.sine_of_sum(theta, m.xi) * psi
    return -eq.forcing_inertia(m) * eq.rod_slope(theta, m.xi) + eq.coupling(m) * turned


@kernel
def kinetic_energy(theta: float, speed: float, psi: float, rate: float, m: Mechanism) -> float:
    """T of the expansion."""
    return (
        0.5 * crank_inertia(theta, psi, m) * speed**2
        + mixed_inertia(theta, psi, m) * speed * rate
        + 0.5 * eq.inertia(m) * rate**2
    )


@kernel
def crank_torque(
    at: Crank, psi: float, rate: float, rate_change: float, wall_force: float, m: Mechanism
) -> float:
    """Torque that the mechanism takes from the crank (over M l^2); `rate_change` is psi''.

    A theta'' + B psi'' + A_theta theta'^2/2 + A_psi theta' psi' + B_psi psi'^2, the friction moment of
    the joint (also through phi), and the reaction of the wall force (over M l, towards -psi).
    """
    theta, speed, acceleration = at
    slope, curvature = eq.rod_slope(theta, m.xi), eq.rod_curvature(theta, m.xi)
    cosine, sine = eq.cosine_of_sum(theta, m.xi), eq.sine_of_sum(theta, m.xi)
    k = eq.coupling(m)
    turned = cosine * (1.0 - 0.5 * psi**2) + sine * psi
    turned_slope = (1.0 + slope) * (cosine * psi - sine * (1.0 - 0.5 * psi**2))
    half_a_theta = eq.inertia(m) * slope * curvature - k * (turned_slope * slope + turned * curvature)
    a_psi = -2.0 * k * (sine - cosine * psi) * slope
    return (
        crank_inertia(theta, psi, m) * acceleration
        + mixed_inertia(theta, psi, m) * rate_change
        + half_a_theta * speed**2
        + a_psi * speed * rate
        + k * sine * rate**2
        + m.damping * eq.joint_rate(theta, speed, rate, m) * (1.0 + slope)
        + wall_force * wall_lever(theta, psi, m)
    )


@kernel
def wall_lever(theta: float, psi: float, m: Mechanism) -> float:
    """d(y/l)/d theta at fixed psi, with y = l Lambda psi: the wall force's lever on the crank."""
    return psi * eq.rod_cosine(theta, m.xi) * eq.narrowing(theta, m.xi)


@kernel
def crank_impulse(theta: float, psi: float, rate_jump: float, m: Mechanism) -> float:
    """Angular impulse taken from the crank (over M l^2) by an impact that changes psi' by `rate_jump`.

    At a crank of given speed: B jump, and the reaction of the wall's impulse -a jump / Lambda.
    """
    reaction = -eq.inertia(m) * rate_jump / eq.rod_cosine(theta, m.xi) * wall_lever(theta, psi, m)
    return mixed_inertia(theta, psi, m) * rate_jump + reaction
