"""F 4.3: trends of the motions at small friction."""

from __future__ import annotations

import numpy as np

from ..cases import CYCLES, GAPS, HIGH_DAMPINGS, LOW_DAMPINGS, Case, matrix
from ..impacts import BINS, LOWER, UPPER, mean_approach, on_wall, severity, spread
from ..kinds import CHAOTIC, observed
from ..runs import STARTS, Runs
from .judging import Check, Found, Statement, Verdict, in_both_forms, met_if

PERIODIC_CASE = Case(0.05, 0.015)
# Very small beside the mean of about 0.04.
SLOW = 0.004
# "Very slight" changes of a parameter.
SLIGHT = 0.02


def gap_misprint(runs: Runs) -> Statement:
    return Statement(
        "gap-misprint",
        "4.3",
        "The matrix has ρ = 0.01, 0.015, 0.2",
        "figures, captions and text that follow have ρ = 0.020",
        Verdict.CANNOT,
        "a misprint: ρ = 0.2 would let |ψ| reach 12°, beyond the equation linear in ψ",
    )


def listed_twice(runs: Runs) -> Statement:
    return Statement(
        "listed-twice",
        "4.3",
        "Transient chaos at (0.025, 0.01), (0.025, 0.01), 0.015), and (0.075, 0.01) (Figs. 4.6, 4.7, 4.12)",
        "Fig. 4.7 is (0.025, 0.015)",
        Verdict.CANNOT,
        "a pair stands twice in the copy at hand; the second is (0.025, 0.015)",
    )


def matrix_kinds(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        kinds = [observed(runs, case).kind for case in matrix(LOW_DAMPINGS, form)]
        text = ", ".join(f"{kinds.count(kind)} {kind}" for kind in sorted(set(kinds)))
        return Found(text, met_if(len(set(kinds)) == 3), {kind: kinds.count(kind) for kind in set(kinds)})

    return in_both_forms(
        "matrix-kinds", "4.3", "All three types of response occur in the 3 × 3 matrix", judge
    )


def uniform_if_chaotic(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        cases = matrix((*LOW_DAMPINGS, *HIGH_DAMPINGS), form)
        found = {case: spread(runs.final(case)) for case in cases}
        spreads = {case: value for case, value in found.items() if value == value}
        chaotic = [value for case, value in spreads.items() if observed(runs, case).kind == CHAOTIC]
        other = [value for case, value in spreads.items() if observed(runs, case).kind != CHAOTIC]
        least, most = min(chaotic, default=float("nan")), max(other, default=float("nan"))
        ranges = f"chaotic {_range(chaotic)}, others {_range(other)}"
        good = bool(chaotic) and bool(other) and least > most
        return Found(
            f"uniformity of the impact velocities over {BINS} parts of the walls (1 even, 0 one spot): "
            f"{ranges}",
            met_if(good),
            {"least_chaotic": least, "most_other": most},
        )

    return in_both_forms(
        "uniform-if-chaotic",
        "Abstract, 4.3, 5",
        "Chaotic motions give quite uniform distributions of impacts, periodic ones highly localized impacts",
        judge,
        "of 3000 cycles, or of one period after the transient. Chaos in narrow bands, as at (0.15, 0.01), "
        "wears in spots too; corrected, what slides may have a period of hundreds of cycles and wear as "
        "evenly as chaos",
    )


def _range(values: list[float]) -> str:
    return f"{min(values):.2f}-{max(values):.2f}" if values else "none"


def background(runs: Runs) -> Statement:
    """The share of impacts during the transient, after F's 30 cycles."""
    case = Case(0.075, 0.01)

    def judge(form: str) -> Found:
        shares = []
        length = runs.kind(case.in_form(form)).transient
        for cycles in (1500, CYCLES):
            events = runs.events(case.in_form(form), cycles).impacts
            shares.append(float(np.mean(events.cycle < length)))
        return Found(
            f"{case}: {100 * shares[0]:.1f} % of the impacts of 1500 cycles and {100 * shares[1]:.1f} % of "
            f"3000 are of the transient ({length} cycles)",
            met_if(shares[1] < shares[0]),
            {"of_1500": shares[0], "of_3000": shares[1]},
        )

    return in_both_forms(
        "background",
        "4.3",
        "In transient chaos the uniform background of the distribution decreases with the length of the "
        "sample",
        judge,
    )


def faster_with_gap(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        rows = {}
        for damping in LOW_DAMPINGS:
            rows[damping] = [
                mean_approach(runs.events(Case(damping, gap, form=form)).impacts) for gap in GAPS
            ]
        text = "; ".join(f"λ = {d:g}: {_row(values)}" for d, values in rows.items())
        return Found(
            f"mean velocity at ρ = 0.010, 0.015, 0.020: {text}",
            met_if(all(np.all(np.diff(values) > 0.0) for values in rows.values())),
            {f"{d:g}_{gap:g}": v for d, values in rows.items() for gap, v in zip(GAPS, values, strict=True)},
        )

    return in_both_forms(
        "faster-with-gap",
        "4.3, 5",
        "As a general rule the average impact velocities increase with the gap",
        judge,
        "velocities of approach to the wall, over lΩ",
    )


def longer_flights(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        rows = {}
        for damping in LOW_DAMPINGS:
            rows[damping] = [
                2.0 * np.pi * CYCLES / len(runs.events(Case(damping, gap, form=form)).impacts.theta)
                for gap in GAPS
            ]
        text = "; ".join(f"λ = {d:g}: {', '.join(f'{v:.2f}' for v in values)}" for d, values in rows.items())
        return Found(
            f"mean rad between impacts at ρ = 0.010, 0.015, 0.020: {text}",
            met_if(all(values[-1] > values[0] for values in rows.values())),
        )

    return in_both_forms(
        "longer-flights", "4.3, 5", "… as the free motion has a longer time to build up momentum", judge
    )


def _row(values: list[float]) -> str:
    return ", ".join(f"{value:.4f}" for value in values)


def upper_harder(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        differences, wrong = [], []
        for damping in LOW_DAMPINGS:
            row = []
            for gap in GAPS:
                events = runs.events(Case(damping, gap, form=form))
                up, low = (mean_approach(on_wall(events, side)) for side in (UPPER, LOWER))
                row.append(up - low)
                if up <= low:
                    wrong.append(f"({damping:g}, {gap:g})")
            differences.append(float(np.mean(row)))
        text = ", ".join(f"{value:+.4f}" for value in differences)
        return Found(
            "mean velocity on the upper wall less that on the lower, mean over ρ, at λ = 0.025, 0.05, "
            f"0.075: {text}; lower wall hit harder at {', '.join(wrong) or 'none'}",
            met_if(not wrong and bool(np.all(np.diff(differences) > 0.0))),
            {f"difference_{d:g}": v for d, v in zip(LOW_DAMPINGS, differences, strict=True)},
        )

    return in_both_forms(
        "upper-harder",
        "4.3",
        "As expected, impact velocities are greater on the upper wall than on the lower, the more the "
        "larger λ",
        judge,
        "by the mean over a wall's impacts; the upper wall has many small ones",
    )


def upper_worn(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        ratios = []
        for damping in LOW_DAMPINGS:
            walls = [0.0, 0.0]
            for gap in GAPS:
                events = runs.events(Case(damping, gap, form=form))
                for n, side in enumerate((UPPER, LOWER)):
                    walls[n] += severity(on_wall(events, side), CYCLES)
            ratios.append(walls[0] / walls[1])
        text = ", ".join(f"{ratio:.2f}" for ratio in ratios)
        return Found(
            f"velocities per cycle, upper wall over lower, at λ = 0.025, 0.05, 0.075: {text}",
            met_if(min(ratios) > 1.0 and bool(np.all(np.diff(ratios) > 0.0))),
            {f"ratio_{d:g}": v for d, v in zip(LOW_DAMPINGS, ratios, strict=True)},
        )

    return in_both_forms(
        "upper-worn",
        "4.3, Figs. 4.6-4.14",
        "The same, of the profiles' areas",
        judge,
        "the bars of (3.6) weigh the velocities by the number of impacts",
    )


def slow_impacts(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        least = {case: float(runs.events(case).impacts.approach.min()) for case in matrix(LOW_DAMPINGS, form)}
        without = [str(case) for case, value in least.items() if value > SLOW]
        slowest = max(least.values())
        return Found(
            f"{len(least) - len(without)} of {len(least)} cases have impacts slower than {SLOW}; the "
            f"slowest are {min(least.values()):.0e} to {slowest:.0e}"
            + (f"; not {', '.join(without)}" if without else ""),
            met_if(not without),
            {"slowest": slowest},
        )

    return in_both_forms(
        "slow-impacts",
        "4.3",
        "In all cases there are regions of very small impact velocities",
        judge,
        "very small: below a tenth of the mean; periodic motions have a few velocities only",
    )


def slight_changes(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        case = PERIODIC_CASE.in_form(form)
        found = {
            share: observed(runs, Case(case.damping, case.gap * (1.0 + share), form=form)).kind
            for share in (-SLIGHT, -0.5 * SLIGHT, 0.0, 0.5 * SLIGHT, SLIGHT)
        }
        text = ", ".join(f"{100 * share:+.0f} %: {kind}" for share, kind in found.items())
        return Found(
            f"{case} with ρ changed by {text}",
            met_if(found[0.0] != CHAOTIC and CHAOTIC in found.values()),
        )

    return in_both_forms(
        "slight-changes",
        "4.3",
        "Very slight changes of the parameters render the periodic motions chaotic",
        judge,
        f"very slight: up to {100 * SLIGHT:.0f} %",
    )


def no_prediction(runs: Runs) -> Statement:
    return Statement(
        "no-prediction",
        "4.3, 5",
        "Chaos and periodicity occur without rhyme or reason; an a priori prediction is impossible",
        f"every kind here is found by computing, from {STARTS} starts",
        Verdict.UNCHECKED,
        "an impossibility cannot be computed; windows of periodicity in a map of the exponent have an "
        "order, and sliding makes a motion periodic for a reason",
    )


BEFORE: tuple[Check, ...] = (gap_misprint, matrix_kinds, listed_twice)
CHECKS: tuple[Check, ...] = (
    uniform_if_chaotic, background, faster_with_gap, longer_flights,
    upper_harder, upper_worn, slow_impacts, slight_changes, no_prediction,
)  # fmt: skip
