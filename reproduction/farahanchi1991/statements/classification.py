"""F 4.3 and 4.4: which of F's cases are chaotic, transiently chaotic or periodic."""

from __future__ import annotations

from ..cases import Case
from ..kinds import CHAOTIC, PERIODIC, TRANSIENT_CHAOS, observed
from ..runs import Runs
from .judging import Check, Found, Statement, in_both_forms, met_if

# (lambda, rho): F's word, figure.
NON_SLIDING = {
    (0.025, 0.01): (TRANSIENT_CHAOS, "4.6"),
    (0.025, 0.015): (TRANSIENT_CHAOS, "4.7"),
    (0.025, 0.02): (CHAOTIC, "4.8"),
    (0.05, 0.01): (CHAOTIC, "4.9"),
    (0.05, 0.015): (PERIODIC, "4.10"),
    (0.05, 0.02): (CHAOTIC, "4.11"),
    (0.075, 0.01): (TRANSIENT_CHAOS, "4.12"),
    (0.075, 0.015): (CHAOTIC, "4.13"),
    (0.075, 0.02): (CHAOTIC, "4.14"),
}
PHRASES = {
    CHAOTIC: "exhibits sustained chaos",
    TRANSIENT_CHAOS: "exhibits transient chaos",
    PERIODIC: "is periodic without a chaotic transient",
}


def stated(case: Case, kind: str, place: str, text: str, key: str, reason: str = "") -> Check:
    """F's word for a case, judged over the starts."""

    def check(runs: Runs) -> Statement:
        def judge(form: str) -> Found:
            seen = observed(runs, case.in_form(form))
            exponent = runs.kind(case.in_form(form)).exponent
            values = {"exponent": exponent, "settled": seen.settled, "median_cycles": seen.median}
            return Found(seen.words, met_if(seen.kind == kind), values)

        return in_both_forms(key, place, text, judge, _with_rule(runs, case, reason))

    return check


def _with_rule(runs: Runs, case: Case, reason: str) -> str:
    """The reason, and what F's threshold of sliding makes of the published case if that is something else."""
    exact, ruled = observed(runs, case), observed(runs, case.by_thesis_rule)
    if exact.kind == ruled.kind:
        return reason
    words = f"as published, with F's sliding threshold 0.005: {ruled.words}"
    return f"{reason}; {words}" if reason else words


def _in_matrix(damping: float, gap: float, kind: str, figure: str) -> Check:
    return stated(
        Case(damping, gap),
        kind,
        f"4.3, Fig. {figure}",
        f"({damping:g}, {gap:g}) {PHRASES[kind]}",
        f"kind-{damping:g}-{gap:g}",
        "F's start is not known: from some starts the transient is shorter than the 30 cycles that F "
        "leaves out"
        if kind == PERIODIC
        else "",
    )


CHECKS: tuple[Check, ...] = tuple(
    _in_matrix(damping, gap, kind, figure) for (damping, gap), (kind, figure) in NON_SLIDING.items()
)
