"""F 4.4: trends of the motions at large friction."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from models.slider_crank.flight.histories import LIFT, ONSET
from models.slider_crank.machine import Machine
from models.slider_crank.motions.classification import classify

from ..cases import CYCLES, GAPS, HIGH_DAMPINGS, LOW_DAMPINGS, THRESHOLD, Case, matrix
from ..impacts import LOWER, UPPER, mean_approach, on_wall
from ..kinds import CHAOTIC, PERIODIC, TRANSIENT_CHAOS, observed
from ..runs import Runs
from .classification import stated
from .judging import Check, Found, Statement, in_both_forms, met_if

SLIDING_CASE = Case(0.20, 0.015)
STATED_PERIODIC = 0.23


def more_periodic(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        counts = [
            sum(observed(runs, Case(damping, gap, form=form)).kind == PERIODIC for gap in GAPS)
            for damping in HIGH_DAMPINGS
        ]
        return Found(
            f"periodic at λ = 0.15, 0.20, 0.25: {', '.join(str(count) for count in counts)} of 3",
            met_if(counts[-1] > counts[0] and counts == sorted(counts)),
            {f"periodic_{d:g}": count for d, count in zip(HIGH_DAMPINGS, counts, strict=True)},
        )

    return in_both_forms(
        "more-periodic",
        "4.4, Figs. 4.24-4.32",
        "Periodic motions are much more prevalent as λ is increased",
        judge,
        "as published (0.15, 0.01) looks periodic too; corrected, all but one are simply at rest on "
        "the upper wall",
    )


def less_chaotic(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        counts = [
            sum(observed(runs, Case(damping, gap, form=form)).kind == CHAOTIC for gap in GAPS)
            for damping in (*LOW_DAMPINGS, *HIGH_DAMPINGS)
        ]
        return Found(
            "chaotic at λ = 0.025, 0.05, 0.075, 0.15, 0.20, 0.25: "
            f"{', '.join(str(count) for count in counts)} of 3",
            met_if(sum(counts[3:]) < sum(counts[:3])),
        )

    return in_both_forms(
        "less-chaotic",
        "4.4",
        "In general dissipation tends to discourage chaos",
        judge,
        "as published only from about λ = 0.22 on; judged by both matrices",
    )


def faster_with_gap(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        rows = {d: [_fastest(runs, Case(d, gap, form=form)) for gap in GAPS] for d in HIGH_DAMPINGS}
        text = "; ".join(f"λ = {d:g}: {', '.join(f'{v:.3f}' for v in row)}" for d, row in rows.items())
        return Found(
            f"largest velocity at ρ = 0.010, 0.015, 0.020: {text}",
            met_if(all(np.all(np.diff(row) > 0.0) for row in rows.values())),
        )

    return in_both_forms(
        "sliding-faster-with-gap",
        "4.4",
        "With sliding too an increase of the gap results in larger impact velocities",
        judge,
        "by the largest velocities, as the mean over a row of bounces that ends in rest has no limit",
    )


def _fastest(runs: Runs, case: Case, side: float = 0.0) -> float:
    events = runs.events(case)
    chosen = on_wall(events, side) if side else events.impacts
    return float(chosen.approach.max()) if len(chosen.approach) else 0.0


def difference_of_walls(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        rows = []
        for damping in HIGH_DAMPINGS:
            events = [runs.events(Case(damping, gap, form=form)) for gap in GAPS]
            up, low = ([mean_approach(on_wall(e, side)) for e in events] for side in (UPPER, LOWER))
            rows.append((float(np.mean(up)), float(np.mean(low))))
        differences = [abs(up - low) for up, low in rows]
        text = "; ".join(f"{up:.4f} and {low:.4f}" for up, low in rows)
        return Found(
            f"mean velocity on the upper and the lower wall, mean over ρ, at λ = 0.15, 0.20, 0.25: {text}",
            met_if(bool(np.all(np.diff(differences) > 0.0))),
            {f"difference_{d:g}": v for d, v in zip(HIGH_DAMPINGS, differences, strict=True)},
        )

    return in_both_forms(
        "difference-of-walls",
        "4.4",
        "Increases of λ increase the difference between the impact velocities on the upper and the lower "
        "wall",
        judge,
        "at λ = 0.25 the lower wall is not hit at all",
    )


def slides_not_seldom(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        case = SLIDING_CASE.in_form(form)
        events = runs.events(case)
        slow = float(np.mean(0.9 * events.impacts.approach < THRESHOLD)) if len(events.impacts.theta) else 0.0
        exact, ruled = (int((runs.events(c).kind == ONSET).sum()) for c in (case, case.by_thesis_rule))
        share = runs.sliding_share(case)
        text = (
            f"slides {exact} times in {CYCLES} cycles, {ruled} times with F's threshold; {100 * slow:.1f} % "
            "of the impacts rebound with less than 0.005, where nothing presses the roller to the wall"
        )
        if share > 0.0:
            text = f"slides {100 * share:.0f} % of the time, from its first cycles on"
        return Found(text, met_if(min(exact, ruled) > CYCLES / 100), {"exact": exact, "ruled": ruled})

    return in_both_forms(
        "slides-not-seldom",
        "4.4, Fig. 4.33",
        "(0.20, 0.015): during the chaotic motion sliding occurs not infrequently",
        judge,
        "F's routine may have taken any slow impact for the beginning of sliding, also where the force "
        "points away from the wall; a motion that truly slides is released from a fixed state, so that "
        "what follows is always the same: recurrent sliding and chaos exclude each other",
    )


def simple_periodic(runs: Runs) -> Statement:
    """lambda from which the motion has period 1, at rho = 0.015."""

    def first(threshold: float, form: str) -> float:
        def excess(damping: float) -> float:
            return 0.5 - (
                classify(Machine(damping, 0.015, 0.9, form, sliding_threshold=threshold), 2000).period == 1
            )

        grid = np.arange(0.250, 0.2095, -0.001)
        last = next((d for d in grid if excess(float(d)) > 0.0), None)
        if last is None:
            return float(grid[-1])
        return float(brentq(excess, last, last + 0.001, xtol=1e-5))

    def judge(form: str) -> Found:
        exact, ruled = first(0.0, form), first(THRESHOLD, form)
        texts = [
            "at every λ from 0.21 on" if value < 0.2105 else f"from λ = {value:.4f} on"
            for value in (exact, ruled)
        ]
        return Found(
            f"period 1 {texts[0]}, with F's threshold {texts[1]}",
            met_if(exact <= STATED_PERIODIC),
            {"exact": exact, "ruled": ruled},
        )

    return in_both_forms(
        "simple-periodic",
        "4.4",
        "At ρ = 0.015 simple periodic motion occurs for λ = 0.23 and above",
        judge,
        "as published met with F's threshold only: at 0.23 the exact motion has a longer period, as its "
        "bounces are not cut off",
    )


def low_velocity_cycles(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        events = runs.events(Case(0.25, 0.015, form=form))
        onsets, lifts = (int((events.kind == kind).sum()) for kind in (ONSET, LIFT))
        ratio = onsets / CYCLES
        return Found(
            f"{ratio:g} beginnings of sliding and {lifts / CYCLES:g} releases per cycle",
            met_if(onsets == lifts == CYCLES),
            {"onsets": ratio, "lifts": lifts / CYCLES},
        )

    return in_both_forms(
        "low-velocity-cycles",
        "4.4, Figs. 4.34, 4.35",
        "(0.25, 0.015): cycles of low velocity impacts end in sliding, then release",
        judge,
        "corrected, the roller stays on the upper wall",
    )


def insensitive(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        gaps = np.linspace(0.01, 0.02, 21)
        periods = [classify(Machine(0.25, float(gap), 0.9, form), 2000).period for gap in gaps]
        return Found(
            "λ = 0.25, 21 gaps from 0.010 to 0.020: periods "
            f"{', '.join(str(p) for p in sorted(set(periods)))}",
            met_if(min(periods) > 0),
        )

    return in_both_forms(
        "insensitive",
        "4.4, Figs. 4.34, 4.36, 4.37",
        "At large λ small variations of the gap do not affect the periodicity",
        judge,
    )


def matrix_kinds(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        kinds = {case: observed(runs, case) for case in matrix(HIGH_DAMPINGS, form)}
        return Found(
            "; ".join(f"{case} {seen.words}" for case, seen in kinds.items()),
            met_if(all(seen.kind == PERIODIC for case, seen in kinds.items() if case.damping == 0.25)),
        )

    return in_both_forms(
        "sliding-matrix",
        "4.4, Figs. 4.24-4.32",
        "The matrix λ = 0.15, 0.20, 0.25: periodic at λ = 0.25",
        judge,
    )


CHECKS: tuple[Check, ...] = (
    matrix_kinds,
    more_periodic,
    less_chaotic,
    faster_with_gap,
    difference_of_walls,
    stated(SLIDING_CASE, CHAOTIC, "4.4, Fig. 4.33", "(0.20, 0.015) is chaotic", "kind-0.2-0.015"),
    slides_not_seldom,
    stated(
        Case(0.22, 0.015),
        TRANSIENT_CHAOS,
        "4.4",
        "(0.22, 0.015): approximately there only transient chaos is observed",
        "kind-0.22-0.015",
    ),
    simple_periodic,
    stated(Case(0.25, 0.015), PERIODIC, "4.4, Fig. 4.35", "(0.25, 0.015) is periodic", "kind-0.25-0.015"),
    low_velocity_cycles,
    insensitive,
)
