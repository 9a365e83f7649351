"""F's abstract and chapter 5."""

from __future__ import annotations

import numpy as np

from ...statement import Statement, Verdict
from ..cases import CYCLES, HIGH_DAMPINGS, LOW_DAMPINGS, TRANSIENT, Case, matrix
from ..kinds import CHAOTIC, PERIODIC, TRANSIENT_CHAOS, observed
from ..runs import STARTS, Runs
from .judging import Check, Found, in_both_forms, met_if

ALL_DAMPINGS = (*LOW_DAMPINGS, *HIGH_DAMPINGS)


def three_types(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        kinds = [observed(runs, case).kind for case in matrix(ALL_DAMPINGS, form)]
        counts = {kind: kinds.count(kind) for kind in (CHAOTIC, TRANSIENT_CHAOS, PERIODIC)}
        text = ", ".join(f"{count} {kind}" for kind, count in counts.items())
        return Found(f"of the 18 pairs (λ, ρ) at e = 0.9: {text}", met_if(min(counts.values()) > 0), counts)

    return in_both_forms(
        "three-types", "Abstract", "Three types of response: chaotic, transient chaos, periodic", judge
    )


def chaos_prevails(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        fast = [observed(runs, case).kind == CHAOTIC for case in matrix(LOW_DAMPINGS, form)]
        slow = [observed(runs, case).kind == CHAOTIC for case in matrix(HIGH_DAMPINGS, form)]
        soft = [observed(runs, case).kind == CHAOTIC for case in matrix(LOW_DAMPINGS, form, 0.5)]
        return Found(
            f"chaotic: {sum(fast)} of 9 at λ ≤ 0.075, e = 0.9; {sum(slow)} of 9 at λ ≥ 0.15; {sum(soft)} of "
            "9 at e = 0.5",
            met_if(sum(fast) > len(fast) / 2 and sum(fast) > sum(slow) and sum(fast) > sum(soft)),
            {"fast": sum(fast), "slow": sum(slow), "soft": sum(soft)},
        )

    return in_both_forms(
        "chaos-prevails",
        "Abstract, 5",
        "Chaos is prevalent at high speed or low friction with nearly ideal impacts; periodic motion at "
        "low speed or low e",
        judge,
        "prevalent: more than half of the cases, and more than at low speed or low e. As published λ = "
        "0.15 and 0.20 are as chaotic as small λ, and only λ = 0.25 is periodic",
    )


def either_observed(runs: Runs) -> Statement:
    case = Case(0.025, 0.01)

    def judge(form: str) -> Found:
        found = runs.settling(case.in_form(form))
        short = int(np.sum(found.lengths + TRANSIENT < CYCLES // 2))
        long = int(np.sum(~found.settled | (found.lengths > CYCLES)))
        return Found(
            f"{case}, {STARTS} starts: {short} would be periodic for most of 3000 cycles, {long} chaotic "
            "throughout",
            met_if(short > 0 and long > 0),
            {"short": short, "long": long},
        )

    return in_both_forms(
        "either-observed",
        "5",
        "Because of transient chaos either chaos or periodicity may be observed, by start and time scale",
        judge,
    )


def fewer_impacts(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        shares, counts = [], []
        for e in (0.9, 0.7, 0.5):
            for case in matrix(ALL_DAMPINGS, form, e):
                ruled = case.by_thesis_rule
                shares.append(runs.sliding_share(ruled))
                counts.append(len(runs.events(ruled).impacts.theta) / CYCLES)
        value = float(np.corrcoef(shares, counts)[0, 1])
        return Found(
            f"correlation of sliding share and impacts per cycle {value:+.2f} (54 cases, F's threshold)",
            met_if(value < 0.0),
            {"correlation": value},
        )

    return in_both_forms(
        "fewer-impacts",
        "5",
        "Increases in sliding duration are typically correlated with fewer impacts per cycle",
        judge,
        "counted with F's threshold, as every slide begins with infinitely many impacts",
    )


def four_dimensions(runs: Runs) -> Statement:
    return Statement(
        "four-dimensions",
        "5",
        "The Poincaré map of a model with two degrees of freedom is four-dimensional",
        "two angles, two rates and the crank angle, less one by the impact's condition: 4",
        Verdict.MET,
    )


def beneficial(runs: Runs) -> Statement:
    return Statement(
        "beneficial",
        "Abstract, 5",
        "Chaotic motions may be beneficial, as they spread wear more evenly",
        "see the uniformities in 4.3; in print a possibility, not a result",
        Verdict.UNCHECKED,
        "wear itself is not modelled, here or in F; what the impacts dissipate stands above",
    )


def unpredictable(runs: Runs) -> Statement:
    return Statement(
        "unpredictable",
        "5",
        "It may be practically impossible to predict the response over a range of speeds with any confidence",
        "-",
        Verdict.UNCHECKED,
        "of motions, beyond some cycles; their statistics and kinds are computed here from any start",
    )


def averages_lost(runs: Runs) -> Statement:
    return Statement(
        "averages-lost",
        "5",
        "An integral average measure cannot be obtained from the pattern of the Poincaré map",
        "(3.6) of the upper wall is the sum of x₂ over the points of Σ by θ",
        Verdict.NOT_MET,
        "the map's points hold angle and velocity of every upper impact; only the printed pattern hides "
        "their number",
    )


ABSTRACT: tuple[Check, ...] = (three_types, chaos_prevails)
CHECKS: tuple[Check, ...] = (
    either_observed, beneficial, fewer_impacts, averages_lost, four_dimensions, unpredictable,
)  # fmt: skip
