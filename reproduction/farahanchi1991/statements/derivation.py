"""F 2.1 to 2.4: derivation of the equation of motion."""

from __future__ import annotations

import math
from itertools import product

import numpy as np

from models.slider_crank.equations import Mechanism, free_moment, inertia, thesis_mechanism

from ...statement import Statement, Verdict, met_if
from ..lagrange import equation, joint_rate, printed, rod_angle_rate
from ..parameters import CRANK_M, GRAVITY
from ..runs import Runs
from .judging import Check

ANGLES = np.linspace(0.1, 6.2, 13)
# States at which printed equations are compared with Lagrange's: psi, psi', psi''.
STATES = tuple(product((-0.02, 0.013), (-0.1, 0.07), (-1.0, 0.4)))
# Central differences in `lagrange` leave 1e-9.
ROUNDING = 1e-7


def mechanism(damping: float = 0.05) -> Mechanism:
    """F's engine as published."""
    return thesis_mechanism(damping)


def largest_fault(rotation: float, **changes: str | float) -> float:
    """Largest difference of a printed left side and Lagrange's equation."""
    m = mechanism()
    return max(
        abs(printed(theta, psi, bend, m, **changes) - equation(theta, psi, rate, bend, rotation, m))
        for theta in ANGLES
        for psi, rate, bend in STATES
    )


def gravity(runs: Runs) -> Statement:
    share = {rpm: GRAVITY / (CRANK_M * (rpm * math.pi / 30.0) ** 2) for rpm in (600, 3000)}
    return Statement(
        "gravity",
        "2.1",
        "Gravity may be ignored when the crank speed is sufficiently large",
        f"g/(rΩ²) = {share[600]:.3f} at 600 r/min, {share[3000]:.4f} at 3000 r/min",
        met_if(share[3000] < 0.01),
        "",
        {f"share_{rpm}_rpm": value for rpm, value in share.items()},
    )


def rod_rotation(runs: Runs) -> Statement:
    m = mechanism()
    theta, psi, rate = 1.0, 0.01, 0.2
    phi_rate = joint_rate(theta, 0.0, m) - 1.0
    seen = rod_angle_rate(theta, psi, rate, m)
    published, corrected = 1.0 + m.alpha / 4.0 - m.beta, 1.0 + m.alpha / 4.0 + m.beta
    return Statement(
        "rod-rotation",
        "2.2, (2.1)",
        "The angular velocity of the connecting rod is φ̇ + ψ̇",
        f"by F's own displacements the rod turns with {seen:.4f} where φ' = {phi_rate:.4f} and ψ' = {rate}: "
        f"φ' − ψ', not φ' + ψ' = {phi_rate + rate:.4f}",
        Verdict.CANNOT,
        "the rod's angle is φ − ψ. The error puts −β for +β into f(τ): its factor of (ξ³ − ξ) sin τ/Λ³ is "
        f"{published:.4f} for {corrected:.4f}. This is the whole difference between the two forms",
        {"rate": seen, "published": published, "corrected": corrected},
    )


def friction_moment(runs: Runs) -> Statement:
    m, theta, rate = mechanism(), 0.7, 0.05
    relative = 1.0 + rod_angle_rate(theta, 0.01, rate, m)
    stated = joint_rate(theta, rate, m)
    return Statement(
        "friction-moment",
        "2.2, (2.6)",
        "The friction moment is −c₂(−θ̇ − φ̇ + ψ̇), proportional to the rate of the rod relative to the crank",
        f"relative rate from the positions {relative:.6f}, θ' + φ' − ψ' = {stated:.6f}",
        met_if(abs(relative - stated) < ROUNDING),
        "it uses the rod's rate φ̇ − ψ̇, which contradicts the φ̇ + ψ̇ of (2.1)",
        {"relative": relative, "stated": stated},
    )


def equation_2_8(runs: Runs) -> Statement:
    fault = largest_fault(1.0, first_sign=-1.0)
    return Statement(
        "equation-2-8",
        "(2.8)",
        "½m{−Ω²rl[sin Ωt cos(φ−ψ) − cos Ωt sin(φ−ψ)] …} − M{Ω²rl[… + l²(φ̈−ψ̈)]} + …",
        f"differs by up to {fault:.3f} M l²Ω² from Lagrange's equation of F's own energy (2.5)",
        Verdict.CANNOT,
        "the first minus must be a plus (as in (2.9)), and l²(φ̈−ψ̈) stands inside a bracket with the "
        "factor Ω²rl, against its unit, here and in (2.9); (2.10) is right in both",
        {"fault": fault},
    )


def scaling(runs: Runs) -> Statement:
    return Statement(
        "scaling",
        "2.3",
        "τ = Ωt and ()' = Ω(˙)",
        "d/dt = Ω d/dτ: (˙) = Ω()'",
        Verdict.CANNOT,
        "the two contradict each other; the equations use (˙) = Ω()'",
    )


def equation_2_10(runs: Runs) -> Statement:
    own, geometric = largest_fault(1.0), largest_fault(-1.0)
    return Statement(
        "equation-2-10",
        "(2.10)",
        "The dimensionless equation of motion follows by Lagrange's method",
        f"differs by {own:.0e} from Lagrange's equation of F's energy with φ' + ψ', by up to "
        f"{geometric:.3f} from that with the rod's rate φ' − ψ'",
        met_if(own < ROUNDING),
        "a right derivation from a wrong energy",
        {"own_energy": own, "rod_energy": geometric},
    )


def linearization(runs: Runs) -> Statement:
    m = mechanism()

    def fault(psi: float) -> float:
        rate = 0.0
        return max(
            abs(
                inertia(m) * bend
                - free_moment(theta, 1.0, 0.0, psi, rate, m)
                - printed(theta, psi, bend, m)
                + m.damping * joint_rate(theta, rate, m)
            )
            for theta in ANGLES
            for bend in (-1.0, 0.4)
        )

    small, large = fault(0.01), fault(0.02)
    return Statement(
        "equation-2-13",
        "(2.13)",
        "Linear in ψ the equation is a ψ'' + b ψ' + c(τ) ψ = f(τ), with these a, b, c, f",
        f"differs from (2.10) by up to {small:.1e} at ψ = 0.01 and {large:.1e} at 0.02: ratio "
        f"{large / small:.2f}, second order",
        met_if(3.8 < large / small < 4.2),
        "a right linearization of the published equation",
        {"at_0.01": small, "at_0.02": large},
    )


def speed_in_lambda(runs: Runs) -> Statement:
    m, psi, rate = mechanism(), 0.01, 0.03
    faults = []
    for speed in (10.0, 300.0):
        in_seconds = m._replace(damping=m.damping * speed)
        moments = [
            free_moment(theta, speed, 0.0, psi, rate * speed, in_seconds) / speed**2
            - free_moment(theta, 1.0, 0.0, psi, rate, m)
            for theta in ANGLES
        ]
        faults.append(max(abs(moment) for moment in moments))
    return Statement(
        "speed-in-lambda",
        "2.4",
        "Only λ depends on the crank speed: to vary λ is to vary the speed",
        f"with c₂ ∝ Ω the moments over Ω² at 10 and 300 rad/s are the same to {max(faults):.0e}",
        met_if(max(faults) < 1e-12),
        "if the coefficient of restitution does not depend on the impact velocity, which is ∝ Ω",
        {"fault": max(faults)},
    )


CHECKS: tuple[Check, ...] = (
    gravity,
    rod_rotation,
    friction_moment,
    equation_2_8,
    scaling,
    equation_2_10,
    linearization,
    speed_in_lambda,
)
