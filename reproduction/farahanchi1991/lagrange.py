"""F's derivation of the equation of motion (F 2.2, 2.6), done numerically from F's displacements.

Everything over M l^2 Omega^2, with tau = theta. `rotation` is +1 for F's rate of the connecting rod
phi' + psi', -1 for that of the rod's angle phi - psi.
"""

import cmath
import math

from models.slider_crank.equations import Mechanism, rod_curvature

# Complex steps have no rounding error; central ones 1e-16 / STEP + STEP^2.
TINY, STEP = 1e-30, 1e-5


def compute_energy(theta: complex, psi: complex, rate: complex, rotation: float, m: Mechanism) -> complex:
    """Kinetic energy T of (2.5)."""
    phi = cmath.asin(m.xi * cmath.sin(theta))
    slope = m.xi * cmath.cos(theta) / cmath.cos(phi)
    turning = slope - rate
    energy = 0.5 * m.beta * (slope + rotation * rate) ** 2
    for mass, along in ((m.alpha, 0.5), (1.0, 1.0)):
        x = -m.xi * cmath.sin(theta) - along * turning * cmath.sin(phi - psi)
        y = m.xi * cmath.cos(theta) - along * turning * cmath.cos(phi - psi)
        energy += 0.5 * mass * (x * x + y * y)
    return energy


def compute_momentum(theta: float, psi: float, rate: float, rotation: float, m: Mechanism) -> float:
    """dT/dpsi'."""
    return compute_energy(theta, psi, rate + TINY * 1j, rotation, m).imag / TINY


def evaluate_lagrange(
    theta: float, psi: float, rate: float, bend: float, rotation: float, m: Mechanism
) -> float:
    """d/dtau (dT/dpsi') - dT/dpsi at psi'' = `bend`."""

    def shift_momentum(s: float) -> float:
        return compute_momentum(theta + s, psi + s * rate, rate + s * bend, rotation, m)

    slope = compute_energy(theta, psi + TINY * 1j, rate, rotation, m).imag / TINY
    return (shift_momentum(STEP) - shift_momentum(-STEP)) / (2.0 * STEP) - slope


def evaluate_printed(
    theta: float, psi: float, bend: float, m: Mechanism, rod_term: str = "(2.10)", first_sign: float = 1.0
) -> float:
    """Left side of the equation of motion as F prints it.

    rod_term: that of "(2.10)", +beta (phi'' + psi''), or of "(2.27)", -beta (phi'' - psi''). first_sign: the
    sign before the first cos tau sin(phi - psi), -1 in (2.8).
    """
    phi = math.asin(m.xi * math.sin(theta))
    turning = rod_curvature(theta, m.xi) - bend
    across, along = math.sin(theta) * math.cos(phi - psi), math.cos(theta) * math.sin(phi - psi)
    rod = -0.5 * m.alpha * (m.xi * (across + first_sign * along) + 0.5 * turning)
    piston = -(m.xi * (across + along) + turning)
    if rod_term == "(2.27)":
        return rod + piston - m.beta * turning
    return rod + piston + m.beta * (rod_curvature(theta, m.xi) + bend)


def compute_rod_rate(theta: float, psi: float, rate: float, m: Mechanism) -> float:
    """Rate of the angle under which the wrist pin is seen from the crank pin, by F's displacements (2.2)."""

    def find_angle(s: float) -> float:
        phi = math.asin(m.xi * math.sin(theta + s)) - (psi + s * rate)
        return math.atan2(math.sin(phi), math.cos(phi))

    return (find_angle(STEP) - find_angle(-STEP)) / (2.0 * STEP)
