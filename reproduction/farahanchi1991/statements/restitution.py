"""F 4.4: smaller coefficients of restitution, and F's captions of these figures."""

from __future__ import annotations

import numpy as np

from ..cases import HIGH_DAMPINGS, LOW_DAMPINGS, Case, matrix
from ..kinds import CHAOTIC, PERIODIC, TRANSIENT_CHAOS, observed
from ..runs import Runs
from .classification import stated
from .judging import Check, Found, Statement, Verdict, in_both_forms, met_if

ALL_DAMPINGS = (*LOW_DAMPINGS, *HIGH_DAMPINGS)
RESTITUTIONS = (0.9, 0.7, 0.5)


def more_sliding(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        shares, chaotic = [], []
        for e in RESTITUTIONS:
            cases = matrix(ALL_DAMPINGS, form, e)
            shares.append(float(np.mean([runs.sliding_share(case) for case in cases])))
            chaotic.append(sum(observed(runs, case).kind == CHAOTIC for case in cases))
        return Found(
            "e = 0.9, 0.7, 0.5, the 18 pairs (λ, ρ): slides "
            f"{', '.join(f'{100 * s:.0f} %' for s in shares)} of the time; "
            f"{', '.join(str(c) for c in chaotic)} irregular",
            met_if(shares == sorted(shares) and chaotic[-1] == 0),
            {f"irregular_{e:g}": count for e, count in zip(RESTITUTIONS, chaotic, strict=True)},
        )

    return in_both_forms(
        "more-sliding",
        "4.4",
        "As e is reduced motions increase their sliding duration and become periodic, over all λ and ρ",
        judge,
    )


def sliding_begins(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        shares = [runs.sliding_share(Case(0.05, 0.02, e, form)) for e in RESTITUTIONS]
        return Found(
            f"(0.05, 0.02), e = 0.9, 0.7, 0.5: slides {', '.join(f'{100 * s:.1f} %' for s in shares)} of "
            "the time",
            met_if(shares[0] == 0.0 and shares == sorted(shares) and shares[-1] > 0.0),
            {f"share_{e:g}": share for e, share in zip(RESTITUTIONS, shares, strict=True)},
        )

    return in_both_forms(
        "sliding-begins",
        "4.4, Figs. 4.42-4.44",
        "Near e = 1 no sliding occurs, and more often as e decreases; the motion develops substantial "
        "sliding",
        judge,
    )


def plastic_impacts(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        cases = matrix(ALL_DAMPINGS, form, 0.0)
        sliding = sum(runs.sliding_share(case) > 0.0 for case in cases)
        regular = sum(observed(runs, case).kind != CHAOTIC for case in cases)
        return Found(
            f"e = 0: {sliding} of {len(cases)} pairs (λ, ρ) slide, {regular} are periodic in the end",
            met_if(sliding == len(cases) and regular > len(cases) // 2),
            {"sliding": sliding, "periodic": regular},
        )

    return in_both_forms(
        "plastic-impacts",
        "4.4",
        "As e → 0 sliding nearly always occurs, as the rebound velocity is zero; periodic motions dominate",
        judge,
        "with e = 0 an impact against the force leaves the roller on the wall but for the instant",
    )


def dominated_by_sliding(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        shares = [runs.sliding_share(case) for case in matrix(ALL_DAMPINGS, form, 0.4)]
        return Found(
            f"e = 0.4: the 18 pairs (λ, ρ) slide {100 * min(shares):.0f} to {100 * max(shares):.0f} % of "
            f"the time, {100 * float(np.mean(shares)):.0f} % on average; {sum(s > 0.0 for s in shares)} of "
            "18 slide",
            met_if(float(np.mean(shares)) > 0.5 and min(shares) > 0.0),
            {"least": min(shares), "mean": float(np.mean(shares))},
        )

    return in_both_forms(
        "dominated-by-sliding",
        "5",
        "With e ≈ 0.4, as in automotive applications, sliding motions will most likely dominate",
        judge,
        "e = 0.4 is cited from Wilson and Fawcett (1974); dominate: more than half of the time",
    )


def wrong_figures(runs: Runs) -> Statement:
    return Statement(
        "wrong-figures",
        "4.4",
        "For (0.05, 0.02): Poincaré maps Figs. 4.21, 4.38, 4.39, distributions Figs. 4.8, 4.40, 4.41",
        "Fig. 4.21 is (0.075, 0.02), Fig. 4.8 is (0.025, 0.02); the captions of 4.40 and 4.41 say λ = 0.025",
        Verdict.CANNOT,
        "text and captions contradict each other; the distribution of (0.05, 0.02), e = 0.9, is Fig. 4.11, "
        "and its Poincaré map is not shown. Figs. 4.40 and 4.41 are drawn for the caption's λ and for the "
        "text's",
    )


def permuted_list(runs: Runs) -> Statement:
    return Statement(
        "permuted-list",
        "List of figures",
        "Figs. 4.15-4.17 are (0.05, 0.015), Figs. 4.18-4.20 (0.025, 0.01)",
        "captions and text: Figs. 4.15-4.17 are (0.025, 0.01), Figs. 4.18-4.20 (0.05, 0.015)",
        Verdict.CANNOT,
        "the list contradicts the captions, which agree with the text; drawn as captioned",
    )


CAPTIONS: tuple[Check, ...] = (permuted_list,)
CHECKS: tuple[Check, ...] = (
    wrong_figures,
    more_sliding,
    stated(
        Case(0.05, 0.02, 0.7),
        TRANSIENT_CHAOS,
        "4.4, Fig. 4.38",
        "(0.05, 0.02), e = 0.7: transient chaos",
        "kind-e-0.7",
    ),
    stated(
        Case(0.05, 0.02, 0.5),
        PERIODIC,
        "4.4, Fig. 4.39",
        "(0.05, 0.02), e = 0.5: periodic motion",
        "kind-e-0.5",
    ),
    sliding_begins,
    plastic_impacts,
)
DISCUSSION: tuple[Check, ...] = (dominated_by_sliding,)
