"""Section 4.1 to 4.3: the constrained multibody equations as they are printed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from models.valve_train.camshaft import shaft_element

from ...statement import Statement, Verdict, met_if
from ..runs import Runs
from .check import Check

# Equations per part (4.3): six pairs of first order and three momenta.
FIRST_ORDER, MOMENTA = 12, 3
MOVING_PARTS = 4
# 4.1: (16)-(19), (20)-(24), (27) and (30), (32).
WRITTEN_CONSTRAINTS = 4 + 5 + 2 + 1
# "2 per cent" as a time (s): C = 0.02 K.
LITERAL_DAMPING = 0.02
LITERAL_FREQUENCY = 500.0


def equation_count(runs: Runs) -> Statement:
    each = FIRST_ORDER + MOMENTA
    return Statement(
        "equation-count",
        "4.3",
        "15 equations per part, four parts without the ground: 60 equations",
        f"{FIRST_ORDER} + {MOMENTA} = {each}; {MOVING_PARTS} × {each} = {MOVING_PARTS * each}; "
        f"{5 * each} for the five parts of Table 1",
        met_if(each == 15 and MOVING_PARTS * each == 60),
        "the arithmetic is right for four parts; the vector of unknowns in the same section has i = 1-5",
        {"equations": MOVING_PARTS * each},
    )


def constraint_count(runs: Runs) -> Statement:
    return Statement(
        "constraint-count",
        "4.1, 4.6",
        "12 constraint functions",
        f"cylindrical 4, translational 5, curve-curve 2, drive 1: {WRITTEN_CONSTRAINTS}",
        met_if(WRITTEN_CONSTRAINTS == 12),
        "",
        {"constraints": WRITTEN_CONSTRAINTS},
    )


def axis_constraints(runs: Runs) -> Statement:
    """(18), (19): sin(theta) sin(phi) = sin(theta) cos(phi) = 0, by (psi, theta, phi)."""
    phi = 0.7  # any: the rank is the same
    gradients = np.array([[0.0, math.sin(phi), 0.0], [0.0, math.cos(phi), 0.0]])
    rank = int(np.linalg.matrix_rank(gradients))
    return Statement(
        "axis-constraints",
        "(18), (19)",
        "Two equations hold the camshaft's axis in Euler 3-1-3 angles",
        f"at θ = 0, where they hold it, their gradients have rank {rank}, not 2",
        Verdict.CANNOT,
        "θ = 0 is the singularity of the 3-1-3 angles; other coordinates are needed",
        {"rank": rank},
    )


def curve_constraint(runs: Runs) -> Statement:
    """(27): dy2/dpsi y3 = 0, of a follower that rides on the cam at 120 degrees."""
    cam = runs.lift(120.0)
    return Statement(
        "curve-constraint",
        "(27), (30)",
        "(∂y2/∂ψ2) y3 = 0 keeps cam and follower in contact",
        f"a follower on the cam at 120° has y3 = {1e3 * cam.s:.3f} mm and (∂y2/∂ψ2) y3 = "
        f"{1e6 * cam.ds * cam.s:.2f} mm²",
        Verdict.CANNOT,
        "not a contact condition; used instead: y3 − s(ψ) = 0",
        {"lift_m": cam.s, "residual_m2": cam.ds * cam.s},
    )


def bending_rate(p: Any) -> float:
    """First angular frequency of the camshaft in bending (rad/s)."""
    e = shaft_element(p)
    masses = np.diag([p.mass, p.transverse_inertia])
    squares = np.linalg.eigvals(np.linalg.solve(masses, [[e.k11, e.k12], [e.k12, e.k22]]))
    return float(np.sqrt(np.min(np.real(squares))))


def field_sign(runs: Runs) -> Statement:
    p = runs.parameters("camshaft")
    bending = bending_rate(p)
    torsion = math.sqrt(shaft_element(p).twist_stiffness / p.polar_inertia)
    return Statement(
        "field-sign",
        "(33)",
        "The field element's force is +[K] δ − [c] dδ/dt",
        f"with + the shaft grows by e in {1e3 / bending:.2f} ms (bending) and {1e3 / torsion:.2f} ms "
        "(torsion); "
        f"with − it oscillates at {bending / (2 * math.pi):.0f} and {torsion / (2 * math.pi):.0f} Hz",
        Verdict.CANNOT,
        "a sign is lost: −[K] δ − [c] dδ/dt",
        {"bending_Hz": bending / (2 * math.pi), "torsion_Hz": torsion / (2 * math.pi)},
    )


def literal_damping(runs: Runs) -> Statement:
    ratio = 0.5 * LITERAL_DAMPING * 2.0 * math.pi * LITERAL_FREQUENCY
    used = runs.parameters("camshaft").shaft_damping_ratio
    return Statement(
        "literal-damping",
        "4.2",
        "Structural damping: 2 per cent of the respective stiffness elements",
        f"C = 0.02 s · K is a damping ratio of {ratio:.1f} at 500 Hz",
        Verdict.CANNOT,
        f"no shaft is damped so; read as a modal damping ratio of {used:g}",
        {"damping_ratio": ratio},
    )


CHECKS: tuple[Check, ...] = (
    axis_constraints,
    curve_constraint,
    constraint_count,
    field_sign,
    literal_damping,
    equation_count,
)
