"""Elastic shaft element between a driven end and a cam: torsion, and bending in two planes.

Kushwaha et al. 2000 (K), equation (33) with the lost sign of the stiffness term; K's "2 per cent" damping is
read as a modal damping ratio (taken as 0.02 s times K it would be a ratio of 31). The shaft turns about z,
anticlockwise; y is the follower's direction and x across it. Its parameters are those of `camshaft`.
"""

import math
from typing import Any, NamedTuple

from ..compile.kernel import kernel


class Shaft(NamedTuple):
    """Stiffness and damping of the element: torsion, and bending in (bending, slope)."""

    twist_stiffness: float
    twist_damping: float
    k11: float
    k12: float
    k22: float
    c11: float
    c12: float
    c22: float


class Load(NamedTuple):
    """What acts on the cam: forces along the follower's path and across, torque against the rotation."""

    force: float
    force_across: float
    torque: float


class Damping(NamedTuple):
    """Forces and moments by which the bent shaft's damping resists, along the follower's path and across."""

    force: float
    moment: float
    force_across: float
    moment_across: float


@kernel
def shaft_element(p: Any) -> Shaft:
    """K (33) at the cam's node, and a damping matrix that gives every mode the same ratio.

    Bending: C = 2 zeta sqrt(M) sqrt(A) sqrt(M) with A = M^-1/2 K M^-1/2; the root of a 2 x 2 matrix is
    (A + sqrt(det A) I) / sqrt(tr A + 2 sqrt(det A)).
    """
    second_moment = math.pi * p.shaft_diameter**4 / 64.0
    shear_modulus = p.youngs_modulus / (2.0 * (1.0 + p.poissons_ratio))
    twist_stiffness = shear_modulus * 2.0 * second_moment / p.shaft_length
    twist_damping = 2.0 * p.shaft_damping_ratio * math.sqrt(twist_stiffness * p.polar_inertia)
    EJ = p.youngs_modulus * second_moment
    k11 = 12.0 * EJ / p.shaft_length**3
    k12 = -6.0 * EJ / p.shaft_length**2
    k22 = 4.0 * EJ / p.shaft_length
    m1, m2 = math.sqrt(p.mass), math.sqrt(p.transverse_inertia)
    a11, a12, a22 = k11 / p.mass, k12 / (m1 * m2), k22 / p.transverse_inertia
    root = math.sqrt(a11 * a22 - a12 * a12)
    factor = 2.0 * p.shaft_damping_ratio / math.sqrt(a11 + a22 + 2.0 * root)
    c11 = factor * (a11 + root) * p.mass
    c12 = factor * a12 * m1 * m2
    c22 = factor * (a22 + root) * p.transverse_inertia
    return Shaft(twist_stiffness, twist_damping, k11, k12, k22, c11, c12, c22)


@kernel
def tilt_lag(x: Any) -> float:
    """Angle (rad) that the cam's tilt takes from its turn: half the product of both slopes.

    The follower sees psi = driven angle + twist - lag, where the cam is tilted by R = exp(Theta) R_z.
    """
    return 0.5 * x.slope * x.slope_across


@kernel
def tilt_lag_rate(x: Any) -> float:
    return 0.5 * (x.slope_rate * x.slope_across + x.slope * x.slope_across_rate)


@kernel
def spin(x: Any, turning: float) -> float:
    """Angular velocity (rad/s) about the cam's own, tilted axis: Omega + theta' - (phi x phi')/2."""
    return turning + x.twist_rate - 0.5 * (x.slope_across * x.slope_rate - x.slope * x.slope_across_rate)


@kernel
def damp_bending(e: Shaft, x: Any, turning: float) -> Damping:
    """C (q' - i Omega q), q = (bending, slope) across + i along: the damping turns with the shaft.

    It resists the rates that the shaft's material sees.
    """
    rate, slope_rate = x.bending_rate - turning * x.bending_across, x.slope_rate - turning * x.slope_across
    rate_across = x.bending_across_rate + turning * x.bending
    slope_rate_across = x.slope_across_rate + turning * x.slope
    return Damping(
        e.c11 * rate + e.c12 * slope_rate,
        e.c12 * rate + e.c22 * slope_rate,
        e.c11 * rate_across + e.c12 * slope_rate_across,
        e.c12 * rate_across + e.c22 * slope_rate_across,
    )


@kernel
def damping_torque(damped: Damping, x: Any) -> float:
    """Torque (N m) on the shaft's driven end by the damping that turns round the bent shaft, q x C (...)."""
    torque = damped.force_across * x.bending - damped.force * x.bending_across
    return torque + damped.moment_across * x.slope - damped.moment * x.slope_across


@kernel
def dissipate_bending(damped: Damping, x: Any, turning: float) -> float:
    """Power (W) that the damping takes: the rates that the material sees times its forces."""
    lost = damped.force * (x.bending_rate - turning * x.bending_across)
    lost += damped.moment * (x.slope_rate - turning * x.slope_across)
    lost += damped.force_across * (x.bending_across_rate + turning * x.bending)
    return lost + damped.moment_across * (x.slope_across_rate + turning * x.slope)


@kernel
def twist_torque(e: Shaft, x: Any) -> float:
    """k theta + c theta' (N m)."""
    return e.twist_stiffness * x.twist + e.twist_damping * x.twist_rate


@kernel
def bend_shaft(e: Shaft, x: Any, load: Load, turning: float, p: Any, dx: Any) -> None:
    """M q'' + C (q' - i Omega q) + K q = (F, i omega I_p phi' + moments), q = (bending, slope = phi).

    By planes, q = across + i along: M = diag(m, I_t), Omega the speed of the driven end, omega the spin. A
    turning disc resists across its tilt: i omega I_p phi' is its gyroscopic moment. The second-order moments
    (T + t/2) phi_y across and -t phi_x/2 along, T the contact's torque and t the twist's, are Lagrange's for
    `spin` and `tilt_lag`.
    """
    damped, gyroscopic = damp_bending(e, x, turning), p.polar_inertia * spin(x, turning)
    half = 0.5 * twist_torque(e, x)
    dx.bending, dx.slope = x.bending_rate, x.slope_rate
    dx.bending_across, dx.slope_across = x.bending_across_rate, x.slope_across_rate
    restored = e.k11 * x.bending + e.k12 * x.slope + damped.force
    dx.bending_rate = (load.force - restored) / p.mass
    restored = e.k11 * x.bending_across + e.k12 * x.slope_across + damped.force_across
    dx.bending_across_rate = (load.force_across - restored) / p.mass
    moment = gyroscopic * x.slope_across_rate - half * x.slope_across
    restored = e.k12 * x.bending + e.k22 * x.slope + damped.moment
    dx.slope_rate = (moment - restored) / p.transverse_inertia
    moment = (load.torque + half) * x.slope - gyroscopic * x.slope_rate
    restored = e.k12 * x.bending_across + e.k22 * x.slope_across + damped.moment_across
    dx.slope_across_rate = (moment - restored) / p.transverse_inertia


@kernel
def bending_energy(e: Shaft, bending: float, slope: float) -> float:
    """Twice the elastic energy of one plane: q^T K q."""
    return e.k11 * bending**2 + e.k22 * slope**2 + 2.0 * e.k12 * bending * slope
