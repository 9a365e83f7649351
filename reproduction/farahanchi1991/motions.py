"""F chapter 4: kinds of motion, over cases and starts."""

import math
from collections import Counter
from functools import cache

import numpy as np
from scipy.optimize import brentq

from models.slider_crank.motions.classification import CHAOTIC, PERIODIC, TRANSIENT_CHAOS, classify
from models.slider_crank.motions.histories import LIFT, ONSET
from models.slider_crank.motions.machine import Machine, Motion

from ..statement import Values
from .runs import (
    CYCLES,
    HIGH_DAMPINGS,
    LOW_DAMPINGS,
    MATRIX,
    STARTS,
    THRESHOLD,
    TRANSIENT,
    Case,
    Runs,
    list_cases,
    observe,
)

EXAMPLE, SLIDING = Case(0.05, 0.01), Case(0.20, 0.015)
RESTITUTIONS = (0.9, 0.7, 0.5)
# "Very slight" changes of a parameter.
SLIGHT = 0.02


def _list_kinds(runs: Runs, dampings: tuple[float, ...], form: str, restitution: float = 0.9) -> list[str]:
    return [observe(runs, case).kind for case in list_cases(dampings, form, restitution)]


def describe_motion(runs: Runs, form: str, case: Case) -> Values:
    """The kind of a case over the starts, and what F's threshold of sliding makes of the published one."""
    seen, exact, ruled = (observe(runs, c) for c in (case.in_form(form), case, case.by_thesis_rule))
    rule = (
        f"as published, with F's sliding threshold 0.005: {ruled.words}" if exact.kind != ruled.kind else ""
    )
    return {"kind": seen.kind, "words": seen.words, "rule": rule, "also": rule and f"; {rule}"}


def count_kinds(runs: Runs, form: str) -> Values:
    """How many of the cases are of each kind, at small and at large friction."""
    low, high = (Counter(_list_kinds(runs, dampings, form)) for dampings in (LOW_DAMPINGS, HIGH_DAMPINGS))
    kinds = (CHAOTIC, TRANSIENT_CHAOS, PERIODIC)
    return {
        "each": [f"{low[kind] + high[kind]} {kind}" for kind in kinds],
        "least": min(low[kind] + high[kind] for kind in kinds),
        "low": [f"{low[kind]} {kind}" for kind in sorted(low)],
        "low_kinds": len(low), "high_kinds": len(high),
        "sets": "; ".join(
            f"{words}: {found[CHAOTIC]} chaotic, {found[TRANSIENT_CHAOS]} transiently, "
            f"{found[PERIODIC]} periodic"
            for words, found in (("λ ≤ 0.075", low), ("λ ≥ 0.15", high))
        ),
        "periodic_low": low[PERIODIC], "periodic_high": high[PERIODIC],
    }  # fmt: skip


def count_chaotic(runs: Runs, form: str) -> Values:
    """How many of 9 cases are chaotic at small friction, at large friction, and with e = 0.5; by lambda."""
    counts = [_list_kinds(runs, (damping,), form).count(CHAOTIC) for damping in MATRIX]
    soft = _list_kinds(runs, LOW_DAMPINGS, form, 0.5).count(CHAOTIC)
    return {"fast": sum(counts[:3]), "slow": sum(counts[3:]), "soft": soft, "counts": counts}


def count_starts(runs: Runs, form: str) -> Values:
    """Starts that are periodic for most of F's record, and those that are chaotic throughout."""
    found = runs.settling(Case(0.025, 0.01, form=form))
    return {
        "starts": STARTS, "short": int(np.sum(found.lengths + TRANSIENT < CYCLES // 2)),
        "long": int(np.sum(~found.settled | (found.lengths > CYCLES))),
    }  # fmt: skip


def correlate_sliding(runs: Runs, form: str) -> Values:
    """Correlation of sliding share and impacts per cycle, with F's threshold."""
    cases = [case.by_thesis_rule for e in RESTITUTIONS for case in list_cases(MATRIX, form, e)]
    shares = [runs.sliding_share(case) for case in cases]
    return {"value": np.corrcoef(shares, [len(runs.events(c).impacts.theta) / CYCLES for c in cases])[0, 1]}


def _format_list(cases: list[str]) -> str:
    return f": {'; '.join(cases)}" if cases else ""


def list_unexpected_sliding(runs: Runs, form: str) -> Values:
    """Cases of small friction whose records slide, and others that do so from another start."""
    cases = list_cases(LOW_DAMPINGS, form)
    recorded = [str(case) for case in cases if np.any(runs.events(case).kind == ONSET)]
    other = [str(c) for c in cases if str(c) not in recorded and observe(runs, c).sliding]
    return {"count": len(recorded), "cases": len(cases), "recorded": _format_list(recorded),
            "other": (other and f"; from other starts{_format_list(other)}") or ""}  # fmt: skip


def list_sliding(runs: Runs, form: str) -> Values:
    """Cases of large friction that slide; as published with F's threshold too."""
    cases = list_cases(HIGH_DAMPINGS, form)
    sliding = [str(case) for case in cases if runs.sliding_share(case) > 0.0]
    ruled = [str(c) for c in list_cases(HIGH_DAMPINGS) if runs.sliding_share(c.by_thesis_rule) > 0.0]
    return {"count": len(sliding), "cases": len(cases), "listed": _format_list(sliding),
            "ruled": len(ruled), "ruled_cases": "; ".join(ruled)}  # fmt: skip


def measure_distance(runs: Runs, form: str) -> Values:
    """How far apart successive cycles begin after 25 cycles, over the range of F's print."""
    states = Motion(EXAMPLE.in_form(form).machine).skip(25).strobe(3)[:, :2]
    return {"apart": np.abs(np.diff(states, axis=0) / [2.0 * EXAMPLE.gap, 0.2]).max(axis=1).min()}


def find_exponent(runs: Runs, form: str) -> Values:
    kind = runs.kind(EXAMPLE.in_form(form))
    return {"kind": kind.kind, "evidence": kind.evidence,
            "exponent": kind.exponent, "error": kind.uncertainty}  # fmt: skip


def compute_dimension(runs: Runs, form: str) -> Values:
    """Kaplan-Yorke dimension of the section."""
    found = Motion(EXAMPLE.in_form(form).machine).skip(100).exponents(20_000)
    if found.largest == -math.inf:
        return {"words": "a finite set of points: the motion is periodic in the end", "dimension": 0.0}
    second = found.exact_sum - found.largest
    dimension = 1.0 - found.largest / second
    words = f"exponents {found.largest:.4f} and {second:.4f}: Kaplan-Yorke dimension {dimension:.3f}"
    return {"words": f"{words} of the section", "dimension": dimension}


def vary_gap(runs: Runs, form: str) -> Values:
    """The kinds at (0.05, 0.015) with slightly other gaps."""
    shares = (-SLIGHT, -0.5 * SLIGHT, 0.0, 0.5 * SLIGHT, SLIGHT)
    kinds = [observe(runs, Case(0.05, 0.015 * (1.0 + share), form=form)).kind for share in shares]
    return {
        "kinds": kinds,
        "each": [f"{100 * s:+.0f} %: {kind}" for s, kind in zip(shares, kinds, strict=True)],
    }


def describe_matrix(runs: Runs, form: str) -> Values:
    """The motions of the cases of large friction."""
    seen = {case: observe(runs, case) for case in list_cases(HIGH_DAMPINGS, form)}
    counts = [_list_kinds(runs, (damping,), form).count(PERIODIC) for damping in HIGH_DAMPINGS]
    return {"each": "; ".join(f"{case} {one.words}" for case, one in seen.items()), "periodic": counts}


def count_slides(runs: Runs, form: str) -> Values:
    """How often (0.20, 0.015) slides, exactly and with F's threshold."""
    case = SLIDING.in_form(form)
    approach, share = runs.events(case).impacts.approach, runs.sliding_share(case)
    slow = float(np.mean(0.9 * approach < THRESHOLD)) if len(approach) else 0.0
    exact, ruled = (int((runs.events(c).kind == ONSET).sum()) for c in (case, case.by_thesis_rule))
    words = (
        f"slides {exact} times in {CYCLES} cycles, {ruled} times with F's threshold; {100 * slow:.1f} % of "
        "the impacts rebound with less than 0.005, where nothing presses the roller to the wall"
    )
    if share > 0.0:
        words = f"slides {100 * share:.0f} % of the time, from its first cycles on"
    return {"words": words, "exact": exact, "ruled": ruled}


def find_simple_periodic(runs: Runs, form: str) -> Values:
    """lambda from which the motion has period 1 at rho = 0.015, exactly and with F's threshold."""

    def find_first(threshold: float) -> float:
        def evaluate_period(damping: float) -> float:
            machine = Machine(damping, 0.015, 0.9, form, sliding_threshold=threshold)
            return 0.5 - (classify(machine, 2000).period == 1)

        grid = np.arange(0.250, 0.2095, -0.001)
        last = next((d for d in grid if evaluate_period(float(d)) > 0.0), None)
        return (
            float(grid[-1]) if last is None else float(brentq(evaluate_period, last, last + 0.001, xtol=1e-5))
        )

    exact, ruled = find_first(0.0), find_first(THRESHOLD)
    words = ["at every λ from 0.21 on" if v < 0.2105 else f"from λ = {v:.4f} on" for v in (exact, ruled)]
    return {"exact": exact, "exact_words": words[0], "ruled_words": words[1]}


def count_releases(runs: Runs, form: str) -> Values:
    """Beginnings of sliding and releases per cycle at (0.25, 0.015)."""
    kinds = runs.events(Case(0.25, 0.015, form=form)).kind
    return {"onsets": (kinds == ONSET).sum() / CYCLES, "lifts": (kinds == LIFT).sum() / CYCLES}


def find_periods(runs: Runs, form: str) -> Values:
    """Periods at lambda = 0.25 over the gaps."""
    gaps = np.linspace(0.01, 0.02, 21)
    return {"periods": sorted({classify(Machine(0.25, float(gap), 0.9, form), 2000).period for gap in gaps})}


@cache
def compare_restitutions(runs: Runs, form: str) -> Values:
    """By e, over all pairs (lambda, rho): share of sliding, irregular motions; sliding at (0.05, 0.02)."""
    return {
        "shares": [
            np.mean([runs.sliding_share(c) for c in list_cases(MATRIX, form, e)]) for e in RESTITUTIONS
        ],
        "irregular": [_list_kinds(runs, MATRIX, form, e).count(CHAOTIC) for e in RESTITUTIONS],
        "alone": [runs.sliding_share(Case(0.05, 0.02, e, form)) for e in RESTITUTIONS],
    }


def measure_sliding(runs: Runs, form: str, restitution: float) -> Values:
    """Of all pairs (lambda, rho) with this restitution."""
    shares = [runs.sliding_share(case) for case in list_cases(MATRIX, form, restitution)]
    kinds = _list_kinds(runs, MATRIX, form, restitution)
    return {
        "cases": len(shares), "sliding": sum(share > 0.0 for share in shares),
        "least": min(shares), "least_percent": 100 * min(shares), "most": max(shares),
        "mean": np.mean(shares), "regular": len(kinds) - kinds.count(CHAOTIC),
    }  # fmt: skip
