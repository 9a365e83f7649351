"""F 2.1 to 2.6 and appendix A: the engine, the equations as printed, walls and impacts.

F's derivation of the equation of motion (F 2.2, 2.6), done numerically from F's displacements.

Everything over M l^2 Omega^2, with tau = theta. `rotation` is +1 for F's rate of the connecting rod
phi' + psi', -1 for that of the rod's angle phi - psi.
"""

import cmath
import math
from functools import cache
from itertools import product

import numpy as np

from models.slider_crank import forms, nonlinear
from models.slider_crank.equations import (
    THESIS_ALPHA,
    THESIS_BETA,
    THESIS_XI,
    Crank,
    Mechanism,
    free_moment,
    inertia,
    joint_rate,
    rod_curvature,
    thesis_mechanism,
    wall_angle,
)
from models.slider_crank.motions.machine import Machine, Motion

from ..statement import Values, is_near
from .runs import GAPS, PUBLISHED, Case, Runs

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


INCH_M, GRAVITY = 0.0254, 9.80665
# F's engine (4.1): lb s^2/in, in, lb s^2 in; as printed.
ROD_MASS, PISTON_MASS, CRANK_IN, ROD_IN, ROD_INERTIA = 0.00399, 0.00210, 1.6535, 5.4570, 0.0295
# Half of the last printed digit of the inertia, 0.0295, and of the mass, 0.00210.
ROUNDED = 0.5e-4 / ROD_INERTIA + 0.5e-5 / PISTON_MASS
# F's engine as published. States of the comparisons: theta; psi, psi', psi''. Walls: a turn.
M = thesis_mechanism(0.05)
ANGLES = np.linspace(0.1, 6.2, 13)
STATES = tuple(product((-0.02, 0.013), (-0.1, 0.07), (-1.0, 0.4)))
TURN = np.linspace(0.0, 2.0 * math.pi, 721)


def compute_engine(runs: Runs) -> Values:
    """F's ratios from F's masses and lengths, and those of rods; gravity beside the crank's acceleration."""
    xi, alpha = CRANK_IN / ROD_IN, ROD_MASS / PISTON_MASS
    beta = ROD_INERTIA / (PISTON_MASS * ROD_IN**2)
    uniform, most = THESIS_ALPHA / 12.0, THESIS_ALPHA / 4.0
    slow, fast = (GRAVITY / (CRANK_IN * INCH_M * (rpm * math.pi / 30.0) ** 2) for rpm in (600, 3000))
    good = (
        is_near(xi, THESIS_XI, 1e-3)
        and is_near(alpha, THESIS_ALPHA, 1e-3)
        and is_near(beta, THESIS_BETA, ROUNDED)
    )
    return {
        "xi": xi, "alpha": alpha, "beta": beta, "good": good,
        "uniform": uniform, "of_uniform": THESIS_BETA / uniform, "most": most, "of_most": THESIS_BETA / most,
        "gravity_slow": slow, "gravity_fast": fast,
    }  # fmt: skip


def compute_rates(runs: Runs) -> Values:
    """Rates of the rod by F's own displacements, beside those that F states."""
    phi_rate, quarter = joint_rate(1.0, 1.0, 0.0, M) - 1.0, 1.0 + M.alpha / 4.0
    return {
        "seen": compute_rod_rate(1.0, 0.01, 0.2, M), "phi_rate": phi_rate, "wrong": phi_rate + 0.2,
        "published": quarter - M.beta, "corrected": quarter + M.beta,
        "relative": 1.0 + compute_rod_rate(0.7, 0.01, 0.05, M), "stated": joint_rate(0.7, 1.0, 0.05, M),
    }  # fmt: skip


def _find_largest_fault(rotation: float, rod_term: str = "(2.10)", first_sign: float = 1.0) -> float:
    """Largest difference of a printed left side and Lagrange's equation."""
    return max(
        abs(
            evaluate_printed(theta, psi, bend, M, rod_term, first_sign)
            - evaluate_lagrange(theta, psi, rate, bend, rotation, M)
        )
        for theta in ANGLES
        for psi, rate, bend in STATES
    )


def _find_linear_fault(psi: float) -> float:
    """Largest difference of (2.13) and (2.10)."""
    return max(
        abs(
            inertia(M) * bend - free_moment(Crank(theta, 1.0, 0.0), psi, 0.0, M)
            - evaluate_printed(theta, psi, bend, M) + M.damping * joint_rate(theta, 1.0, 0.0, M)
        )
        for theta in ANGLES
        for bend in (-1.0, 0.4)
    )  # fmt: skip


def _find_speed_fault(speed: float) -> float:
    """Largest difference of moments over Omega^2 at this speed and in tau, with c2 proportional to Omega."""
    in_seconds, psi, rate = M._replace(damping=M.damping * speed), 0.01, 0.03
    return max(
        abs(
            free_moment(Crank(theta, speed, 0.0), psi, rate * speed, in_seconds) / speed**2
            - free_moment(Crank(theta, 1.0, 0.0), psi, rate, M)
        )
        for theta in ANGLES
    )


@cache
def compare_equations(runs: Runs) -> Values:
    """How far printed equations are from Lagrange's of F's energy, and of that with the rod's right rate."""
    small, large = _find_linear_fault(0.01), _find_linear_fault(0.02)
    return {
        "of_2_8": _find_largest_fault(1.0, first_sign=-1.0),
        "own": _find_largest_fault(1.0), "rod": _find_largest_fault(-1.0),
        "own_2_27": _find_largest_fault(1.0, "(2.27)"), "rod_2_27": _find_largest_fault(-1.0, "(2.27)"),
        "small": small, "large": large, "growth": large / small,
        "speed": max(_find_speed_fault(10.0), _find_speed_fault(300.0)),
    }  # fmt: skip


def check_walls(runs: Runs) -> Values:
    """Exact walls beside the linear ones; the rule of impacts; the lever of the wall's force."""

    def measure_offset(gap: float) -> float:
        return max(abs(nonlinear.wall_angle(t, gap, M.xi) - wall_angle(t, gap, M.xi)) for t in TURN) / gap

    def measure_fault(t: float) -> float:
        psi, e, before = wall_angle(t, 0.02, M.xi), 0.9, 0.05
        drift = M.xi**2 * math.sin(t) * math.cos(t) / (1.0 - (M.xi * math.sin(t)) ** 2) * psi
        after, wall = (1.0 + e) * drift - e * before, forms.wall_rate(forms.AS_PUBLISHED, t, 1.0, psi, M)
        return abs((after - wall) + e * (before - wall))

    phi, psi, h = 0.2, 0.013, 1e-5
    sums = [nonlinear.wall_angle(t, 0.02, M.xi) + nonlinear.wall_angle(t, -0.02, M.xi) for t in TURN]
    return {
        "off": [measure_offset(gap) for gap in GAPS], "sum": max(abs(value) for value in sums),
        "fault": max(measure_fault(t) for t in TURN),
        "lever": (math.sin(phi - psi + h) - math.sin(phi - psi - h)) / (2.0 * h),
        "cosine": math.cos(phi - psi),
    }  # fmt: skip


def sum_bounces(runs: Runs) -> Values:
    """Bounces under a constant push g from a rebound v take 2v/(g(1 - e)); the share of 400 of them."""
    times = np.cumsum(2.0 * 0.9 ** np.arange(400))
    events = Motion(Machine(0.25, 0.015, 0.9, PUBLISHED)).skip(30).events(1).impacts
    return {"share": times[-1] / (2.0 / (1.0 - 0.9)), "impacts": len(events.theta)}


def measure_sliding(runs: Runs) -> Values:
    """Shares of the time in which the roller slides."""
    cases = (Case(0.05, 0.01), Case(0.25, 0.01), Case(0.05, 0.01, 0.5))
    plain, damped, soft = (runs.sliding_share(case) for case in cases)
    return {"plain": plain, "damped": damped, "soft": soft}
