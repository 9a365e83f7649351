"""F 2.5, appendix A and the beginning of 2.6: walls, impacts, coming to rest."""

from __future__ import annotations

import math

import numpy as np

from models.slider_crank import forms, nonlinear
from models.slider_crank.equations import thesis_mechanism, wall_angle
from models.slider_crank.forms import AS_PUBLISHED
from models.slider_crank.machine import Machine, Motion

from ...statement import Statement, met_if
from ..cases import GAPS, Case
from ..runs import Runs
from .judging import Check

ANGLES = np.linspace(0.0, 2.0 * math.pi, 721)


def wall_angles(runs: Runs) -> Statement:
    m = thesis_mechanism(0.05)

    def fault(gap: float) -> float:
        exact = [nonlinear.wall_angle(t, gap, m.xi) for t in ANGLES]
        linear = [wall_angle(t, gap, m.xi) for t in ANGLES]
        return float(np.max(np.abs(np.subtract(exact, linear)))) / gap

    faults = [fault(gap) for gap in GAPS]
    text = ", ".join(f"{100 * value:.2f} %" for value in faults)
    return Statement(
        "wall-angles",
        "(2.14), (A.4)",
        "For |ψ| ≪ 1, ψ_max = ρ/√(1 − ξ² sin²τ)",
        f"off by at most {text} of ρ from sin(φ − ψ) = sin φ − ρ at ρ = 0.010, 0.015, 0.020",
        met_if(faults[-1] < 0.01 and abs(faults[-1] / faults[0] - 2.0) < 0.05),
        "",
        {f"at_{gap}": value for gap, value in zip(GAPS, faults, strict=True)},
    )


def symmetric_walls(runs: Runs) -> Statement:
    m = thesis_mechanism(0.05)
    sums = [nonlinear.wall_angle(t, 0.02, m.xi) + nonlinear.wall_angle(t, -0.02, m.xi) for t in ANGLES]
    largest = float(np.max(np.abs(sums)))
    return Statement(
        "symmetric-walls",
        "2.5",
        "ψ_max = −ψ_min is valid only in the linearized case",
        f"exact walls at ρ = 0.02: |ψ_max + ψ_min| up to {largest:.1e} rad",
        met_if(largest > 1e-6),
        "",
        {"largest_sum": largest},
    )


def impact_rule(runs: Runs) -> Statement:
    m, e, before = thesis_mechanism(0.05), 0.9, 0.05
    worst = 0.0
    for t in ANGLES:
        psi = wall_angle(t, 0.02, m.xi)
        drift = m.xi**2 * math.sin(t) * math.cos(t) / (1.0 - (m.xi * math.sin(t)) ** 2) * psi
        after = (1.0 + e) * drift - e * before
        wall = forms.wall_rate(AS_PUBLISHED, t, 1.0, psi, m)
        worst = max(worst, abs((after - wall) + e * (before - wall)))
    return Statement(
        "impact-rule",
        "(2.16), (2.17)",
        "ẏ_s after = −e ẏ_s before gives ψ̇ after = (1+e) ξ² sin τ cos τ/Λ² ψ − e ψ̇ before",
        f"velocities relative to the wall after and before are in the ratio −e to {worst:.0e}",
        met_if(worst < 1e-15),
        "",
        {"fault": worst},
    )


def coming_to_rest(runs: Runs) -> Statement:
    """Bounces under a constant push g from a rebound v: all of them take 2v/(g(1 - e))."""
    e, v, g = 0.9, 1.0, 1.0
    times = np.cumsum(2.0 * v / g * e ** np.arange(400))
    limit = 2.0 * v / (g * (1.0 - e))
    events = Motion(Machine(0.25, 0.015, e, "as_published")).skip(30).events(1).impacts
    return Statement(
        "coming-to-rest",
        "2.6",
        "The ball comes to rest in finite time after infinitely many bounces; so does the roller",
        f"400 bounces at e = 0.9 take {times[-1] / limit:.12f} of 2v/(g(1 − e)); at (0.25, 0.015) the "
        f"roller is still after {len(events.theta)} impacts, when less than rounding is left of the sum",
        met_if(abs(times[-1] / limit - 1.0) < 1e-12),
        "cited from Greenwood, pp. 160-161, which was not at hand; the sum is its own proof",
        {"share": float(times[-1] / limit), "impacts": float(len(events.theta))},
    )


def when_it_slides(runs: Runs) -> Statement:
    cases = {
        "(0.05, 0.01)": Case(0.05, 0.01),
        "λ = 0.25": Case(0.25, 0.01),
        "e = 0.5": Case(0.05, 0.01, 0.5),
    }
    shares = {words: runs.sliding_share(case) for words, case in cases.items()}
    text = ", ".join(f"{words}: {100 * share:.0f} %" for words, share in shares.items())
    return Statement(
        "when-it-slides",
        "2.6",
        "Sliding occurs when the friction is large or the coefficient of restitution small",
        f"share of the time in which it slides: {text}",
        met_if(shares["(0.05, 0.01)"] == 0.0 and min(list(shares.values())[1:]) > 0.0),
        "",
        shares,
    )


CHECKS: tuple[Check, ...] = (wall_angles, symmetric_walls, impact_rule)
SLIDING: tuple[Check, ...] = (coming_to_rest, when_it_slides)
