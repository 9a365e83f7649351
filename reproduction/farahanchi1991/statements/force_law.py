"""F 2.6: the derivation of the forces of the walls on a sliding roller, and their symmetries."""

from __future__ import annotations

import math

import numpy as np

from models.slider_crank.machine import Machine

from ...statement import Statement, Verdict, met_if
from ..cases import PUBLISHED
from ..forces import LOWER, UPPER, curve
from ..runs import Runs
from .derivation import largest_fault
from .judging import Check, Found, in_both_forms

# Of the largest force: a symmetry that is not exact to this does not hold.
SYMMETRIC = 1e-9


def virtual_work(runs: Runs) -> Statement:
    phi, psi, h = 0.2, 0.013, 1e-5
    lever = (math.sin(phi - psi + h) - math.sin(phi - psi - h)) / (2.0 * h)
    return Statement(
        "virtual-work",
        "(2.22)-(2.26)",
        "δW = −F_u l cos(φ − ψ) δψ",
        f"∂y/∂ψ of y = l sin φ − l sin(φ − ψ): {lever:.8f} l, cos(φ − ψ) = {math.cos(phi - psi):.8f}",
        met_if(abs(lever - math.cos(phi - psi)) < 1e-9),
    )


def repeated_energy(runs: Runs) -> Statement:
    return Statement(
        "repeated-energy",
        "2.6 after (2.26)",
        "T_total (from 2.5) = ½M{… + [rΩ cos Ωt − ½l(φ̇−ψ̇) cos(φ−ψ)]²} + …",
        "(2.4), (2.5): the slider's vertical velocity is r Ω cos Ωt − l(φ̇−ψ̇) cos(φ−ψ)",
        Verdict.CANNOT,
        "a misprint: the ½ belongs to the rod alone; the equation that follows has it right",
    )


def equation_2_27(runs: Runs) -> Statement:
    published, rod = largest_fault(1.0, rod_term="(2.27)"), largest_fault(-1.0, rod_term="(2.27)")
    return Statement(
        "equation-2-27",
        "(2.27), (2.29)",
        "… − β(φ'' − ψ'') = −f_u cos(φ−ψ) + … in (2.27), … + β(φ'' + ψ'') … in (2.29)",
        f"(2.27) differs by up to {published:.3f} from Lagrange's equation of F's energy (2.5) and by "
        f"{rod:.0e} from that with the rod's right rate φ' − ψ'",
        Verdict.CANNOT,
        "the two contradict each other. (2.27) is the right equation, printed once and not used: all "
        "figures follow from (2.10) and (2.29)",
        {"published_energy": published, "rod_energy": rod},
    )


def force_scale(runs: Runs) -> Statement:
    return Statement(
        "force-scale",
        "2.6 after (2.26)",
        "Dividing by M l Ω² gives (2.27)",
        "the terms are moments, M l² Ω²; F_u l over that is f_u = F_u/(M l Ω²), (2.28)",
        Verdict.CANNOT,
        "must be M l² Ω², as in 2.3; (2.27) and (2.28) are right",
    )


def restitution_no_part(runs: Runs) -> Statement:
    values = [curve(Machine(0.1, 0.01, e, PUBLISHED), UPPER, 361) for e in (0.0, 0.5, 1.0)]
    spread = float(np.ptp(values, axis=0).max())
    return Statement(
        "restitution-no-part",
        "2.6",
        "The coefficient of restitution cannot affect the constraint force",
        f"forces with e = 0, 0.5 and 1 differ by {spread:.0e}",
        met_if(spread == 0.0),
        "",
        {"difference": spread},
    )


def symmetry(
    key: str, text: str, damping: float, gap: float, half_turn: bool, holds: bool, why: str
) -> Check:
    """(i) f_u = -f_l, or (ii) f_u(theta + pi) = -f_u(theta)."""

    def judge(form: str) -> Found:
        machine = Machine(damping, gap, form=form)
        upper = curve(machine, UPPER, 721)[:-1]
        other = np.roll(upper, -360) if half_turn else curve(machine, LOWER, 721)[:-1]
        fault = float(np.abs(upper + other).max() / np.abs(upper).max())
        return Found(
            f"sum up to {fault:.2g} of the largest force",
            met_if((fault < SYMMETRIC) is holds),
            {"fault": fault},
        )

    return lambda runs: in_both_forms(key, "2.6", text, judge, why)


EVEN = (
    "false: f(τ) has the term in sin 2τ, which does not change its sign in half a turn. What holds at λ = "
    "0, for every ρ, is f_u(−θ) = f_l(θ)"
)
SYMMETRIES = (
    symmetry("symmetry-i", "ρ = 0, λ = 0: (i) f_u = −f_l", 0.0, 0.0, False, True, ""),
    symmetry("symmetry-ii", "ρ = 0, λ = 0: (ii) f_u(θ + π) = −f_u(θ)", 0.0, 0.0, True, True, EVEN),
    symmetry("symmetry-i-damped", "ρ = 0, λ ≠ 0: (i) holds", 0.05, 0.0, False, True, ""),
    symmetry("symmetry-ii-damped", "ρ = 0, λ ≠ 0: (ii) is broken", 0.05, 0.0, True, False, "also without λ"),
    symmetry("symmetry-i-gap", "ρ ≠ 0, λ = 0: (i) is broken", 0.0, 0.02, False, False, ""),
    symmetry("symmetry-ii-gap", "ρ ≠ 0, λ = 0: (ii) holds", 0.0, 0.02, True, True, EVEN),
)


CHECKS: tuple[Check, ...] = (
    virtual_work,
    repeated_energy,
    equation_2_27,
    force_scale,
    restitution_no_part,
    *SYMMETRIES,
)
