"""F 4.1: the engine and the kinds of response."""

from __future__ import annotations

import numpy as np

from models.slider_crank.equations import THESIS_ALPHA, THESIS_BETA, THESIS_XI
from models.slider_crank.flight.histories import ONSET

from ...statement import Statement, Verdict, met_if, near
from ..cases import HIGH_DAMPINGS, LOW_DAMPINGS, matrix
from ..kinds import CHAOTIC, PERIODIC, TRANSIENT_CHAOS, observed
from ..parameters import CRANK_IN, PISTON_MASS, ROD_IN, ROD_INERTIA, ROD_MASS
from ..runs import Runs
from .judging import Check, Found, in_both_forms

# Half of the last printed digit of the inertia, 0.0295, and of the mass, 0.00210.
ROUNDED = 0.5e-4 / ROD_INERTIA + 0.5e-5 / PISTON_MASS


def ratios(runs: Runs) -> Statement:
    xi, alpha = CRANK_IN / ROD_IN, ROD_MASS / PISTON_MASS
    beta = ROD_INERTIA / (PISTON_MASS * ROD_IN**2)
    good = near(xi, THESIS_XI, 1e-3) and near(alpha, THESIS_ALPHA, 1e-3) and near(beta, THESIS_BETA, ROUNDED)
    return Statement(
        "ratios",
        "4.1",
        "The engine's masses and lengths give ξ = 0.3030, α = 1.9000, β = 0.4719",
        f"ξ = {xi:.4f}, α = {alpha:.4f}, β = {beta:.4f}",
        met_if(good),
        "β within what the printed digits of I_r and M leave open",
        {"xi": xi, "alpha": alpha, "beta": beta},
    )


def uniform_rod(runs: Runs) -> Statement:
    uniform, most = THESIS_ALPHA / 12.0, THESIS_ALPHA / 4.0
    return Statement(
        "uniform-rod",
        "2.2, 4.1",
        "The connecting rod is uniform, with β = 0.4719",
        f"a uniform rod has β = α/12 = {uniform:.4f}; {THESIS_BETA} is {THESIS_BETA / uniform:.2f} times "
        f"that and {100 * THESIS_BETA / most:.1f} % of α/4 = {most:.4f}, all of its mass at its ends",
        Verdict.CANNOT,
        "no connecting rod has that; kept, as all figures follow from it",
        {"uniform": uniform, "most": most},
    )


def ford_engine(runs: Runs) -> Statement:
    return Statement(
        "ford-engine",
        "4.1",
        "The values are those of a Ford four-cylinder engine",
        "-",
        Verdict.UNCHECKED,
        "cited from Denman (1988), which was not at hand",
    )


def no_sliding(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        cases = matrix(LOW_DAMPINGS, form)
        recorded = [str(case) for case in cases if np.any(runs.events(case).kind == ONSET)]
        other = [str(c) for c in cases if str(c) not in recorded and observed(runs, c).sliding]
        text = f"{len(recorded)} of {len(cases)} records have sliding{_listed(recorded)}"
        if other:
            text += f"; from other starts{_listed(other)}"
        return Found(text, met_if(not recorded), {"sliding_cases": len(recorded)})

    return in_both_forms(
        "no-sliding",
        "4.1, 4.3",
        "For small λ and e near 1 (λ ≤ 0.075, e = 0.9) no sliding is observed in the steady state",
        judge,
        "judged by records from the middle of the gap",
    )


def _listed(cases: list[str]) -> str:
    return f": {'; '.join(cases)}" if cases else ""


def with_sliding(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        cases = matrix(HIGH_DAMPINGS, form)
        sliding = [str(case) for case in cases if runs.sliding_share(case) > 0.0]
        return Found(
            f"{len(sliding)} of {len(cases)} cases slide{': ' + '; '.join(sliding) if sliding else ''}",
            met_if(len(sliding) == len(cases)),
            {"sliding_cases": len(sliding)},
        )

    ruled = [str(c) for c in matrix(HIGH_DAMPINGS) if runs.sliding_share(c.by_thesis_rule) > 0.0]
    return in_both_forms(
        "with-sliding",
        "4.1, 4.4",
        "λ = 0.15, 0.20, 0.25 are large enough that sliding occurs in the steady state",
        judge,
        f"with F's threshold as published {len(ruled)} slide: {'; '.join(ruled)}. At λ = 0.15 and 0.20 the "
        "bounces are cut short by the release before they come to rest: what F takes for sliding is a row "
        "of small impacts, whose end the next flight remembers",
    )


def kinds_in_both(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        sets = {
            "λ ≤ 0.075": [observed(runs, case).kind for case in matrix(LOW_DAMPINGS, form)],
            "λ ≥ 0.15": [observed(runs, case).kind for case in matrix(HIGH_DAMPINGS, form)],
        }
        text = "; ".join(
            f"{words}: {kinds.count(CHAOTIC)} chaotic, {kinds.count(TRANSIENT_CHAOS)} transiently, "
            f"{kinds.count(PERIODIC)} periodic"
            for words, kinds in sets.items()
        )
        every = all(len(set(kinds)) == 3 for kinds in sets.values())
        low, high = (kinds.count(PERIODIC) for kinds in sets.values())
        return Found(text, met_if(every and high > low), {"periodic_low": low, "periodic_high": high})

    return in_both_forms(
        "kinds-in-both",
        "4.1",
        "All three kinds are observed with and without sliding, periodic motions more often with it",
        judge,
        "by the cases of 4.3 and 4.4; what slides again and again cannot be chaotic: it is released at a "
        "fixed crank angle from rest on the wall, and is exactly periodic in the end",
    )


CHECKS: tuple[Check, ...] = (ratios, uniform_rod, ford_engine, no_sliding, with_sliding, kinds_in_both)
