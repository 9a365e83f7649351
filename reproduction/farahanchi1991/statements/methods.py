"""F chapter 3: Poincare section, impact profile, spectra."""

from __future__ import annotations

import math

import numpy as np

from models.quantities import Vector
from models.slider_crank.equations import THESIS_XI
from models.slider_crank.motions.statistics import impact_profile

from ...statement import Statement, Verdict, met_if
from ..cases import CYCLES, LOW_DAMPINGS, TRANSIENT, Case, matrix
from ..impacts import BINS, UPPER, location, on_wall, profile
from ..runs import Runs
from .judging import Check, Found, in_both_forms

CHAOTIC, SLIDING = Case(0.05, 0.01), Case(0.25, 0.015)


def section(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        least, backward, total = math.inf, 0, 0
        for case in matrix(LOW_DAMPINGS, form):
            upper = on_wall(runs.events(case), UPPER)
            least = min(least, float(upper.rate.min()))
            backward += int(np.sum(upper.rate <= 0.0))
            total += len(upper.rate)
        return Found(
            f"{backward} of {total} upper impacts have ψ' ≤ 0, down to {least:.4f}",
            met_if(backward == 0),
            {"backward": backward, "least": least},
        )

    return in_both_forms(
        "section",
        "(3.4)",
        "Σ = {x₁ = ψ_max, x₂ > 0} holds the impacts on the upper wall",
        judge,
        "the wall itself moves with ψ'_max = ½ξ² sin 2τ ψ_max/Λ²: a slow impact may have x₂ ≤ 0; x₂ > "
        "ψ'_max it must be",
    )


def ends_of_stroke(runs: Runs) -> Statement:
    ends = location(np.array([0.0, math.pi]))
    return Statement(
        "ends-of-stroke",
        "3.2",
        "x ∈ [1 − ξ, 1 + ξ]; x = 1 − ξ at θ = (2n+1)π, x = 1 + ξ at θ = 2nπ",
        f"x = {ends[0]:.4f} at 0, {ends[1]:.4f} at π; at π/2 {location(np.array([0.5 * math.pi]))[0]:.4f}",
        met_if(abs(ends[0] - 1.0 - THESIS_XI) < 1e-12 and abs(ends[1] - 1.0 + THESIS_XI) < 1e-12),
        "the middle of the stroke is passed after half of the time",
        {"head": float(ends[0]), "crank_end": float(ends[1])},
    )


def profile_average(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        events = runs.events(CHAOTIC.in_form(form)).impacts
        velocities = np.abs(events.rate)
        bars = impact_profile(events, velocities, THESIS_XI, BINS, len(velocities))
        total, mean = float(bars.upper.sum() + bars.lower.sum()), float(velocities.mean())
        return Found(
            f"the bars of (3.6) add up to {total:.5f}, the mean impact velocity is {mean:.5f}",
            Verdict.NOT_MET,
            {"sum": total, "mean": mean},
        )

    return in_both_forms(
        "profile-average",
        "(3.6), (3.7)",
        "⟨ψ̇(Δx_i)⟩ = Σ ψ̇_k/N is the average impact velocity of the interval Δx_i",
        judge,
        "an average would divide by N_i. With N, as F itself notes, it is the average times the share "
        "N_i/N of the impacts; the bars of both walls add up to the mean of all impacts",
    )


def profile_without_limit(runs: Runs) -> Statement:
    exact, rule = (runs.events(case).impacts for case in (SLIDING, SLIDING.by_thesis_rule))
    counts = [len(events.theta) / CYCLES for events in (exact, rule)]
    sums = [float(np.abs(events.approach).sum()) / CYCLES for events in (exact, rule)]
    return Statement(
        "profile-without-limit",
        "(3.6), 4.4",
        "Profiles of motions that slide show the impacts and their severity",
        f"(0.25, 0.015): {counts[1]:.0f} impacts a cycle by F's threshold of sliding, {counts[0]:.0f} until "
        f"rounding, infinitely many in the limit; velocities per cycle {sums[1]:.4f} and {sums[0]:.4f}",
        Verdict.CANNOT,
        "divided by N, the profile of a motion with chatter falls without limit as the threshold is made "
        "smaller; divided by the cycles it converges: so it is drawn and compared here",
        {"impacts_exact": counts[0], "impacts_rule": counts[1], "sum_exact": sums[0], "sum_rule": sums[1]},
    )


def limiting_distribution(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        events = runs.motion(Case(0.025, 0.02, form=form)).events(64 * CYCLES)

        def found(cycles: int) -> Vector:
            return profile(events.where(events.cycle < TRANSIENT + cycles), UPPER, cycles)

        long = found(64 * CYCLES)
        errors = [float(np.abs(found(n * CYCLES) - long).sum() / long.sum()) for n in (1, 4)]
        return Found(
            f"(0.025, 0.02): {100 * errors[0]:.1f} % and {100 * errors[1]:.1f} % away after {CYCLES} and "
            f"{4 * CYCLES} cycles from the profile after {64 * CYCLES}",
            met_if(errors[1] < errors[0]),
            {"after_3000": errors[0], "after_12000": errors[1]},
        )

    return in_both_forms(
        "limiting-distribution",
        "3.2",
        "As N → ∞ the profiles converge to a limiting distribution",
        judge,
    )


def polar_representation(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        upper = on_wall(runs.events(CHAOTIC.in_form(form)), UPPER)
        out = float(np.mean(upper.theta < math.pi))
        return Found(
            f"{100 * out:.0f} % of the upper impacts on the way from the head, {100 * (1 - out):.0f} % on "
            "the way back",
            met_if(min(out, 1.0 - out) == 0.0),
            {"outward": out},
        )

    return in_both_forms(
        "polar-representation",
        "3.3",
        "Impact spectra are a polar representation of the data of the profiles",
        judge,
        "they hold more: θ and 2π − θ are the same place x, and a profile adds them up",
    )


def transient_length(runs: Runs) -> Statement:
    return Statement(
        "transient-length",
        "4.2, appendix B",
        "Transients have decayed after 25 cycles (4.2); 30 are allowed to achieve steady state (appendix B)",
        "25 and 30",
        Verdict.CANNOT,
        f"the two differ; {TRANSIENT} taken. For transient chaos neither is enough",
    )


CHECKS: tuple[Check, ...] = (
    section,
    ends_of_stroke,
    profile_average,
    profile_without_limit,
    limiting_distribution,
    polar_representation,
    transient_length,
)
