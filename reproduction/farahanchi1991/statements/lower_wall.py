"""F 4.4: the lower wall at large friction."""

from __future__ import annotations

import numpy as np

from models.slider_crank.machine import Machine

from ..cases import GAPS, LOW_DAMPINGS, Case
from ..forces import TURN, limits, pressed
from ..impacts import LOWER, location, on_wall
from ..runs import Runs
from .judging import Check, Found, Statement, in_both_forms, met_if


def no_lower_impacts(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        cases = [Case(damping, gap, form=form) for damping in (0.25, 0.26, 0.28, 0.35) for gap in GAPS]
        counts = [len(on_wall(runs.events(case, 300), LOWER).theta) for case in cases]
        return Found(
            f"{sum(counts)} impacts on the lower wall in 300 cycles each at λ = 0.25, 0.26, 0.28, 0.35 and "
            "F's gaps",
            met_if(sum(counts) == 0),
            {"lower": sum(counts)},
        )

    return in_both_forms(
        "no-lower-impacts",
        "4.4",
        "At λ = 0.25, and above, there are no impacts on the lower wall",
        judge,
        "although the force presses towards the lower wall in a part of the cycle",
    )


def lower_wall_trend(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        rows = {}
        for damping in (*LOW_DAMPINGS, 0.15, 0.20):
            low = [on_wall(runs.events(Case(damping, gap, form=form)), LOWER) for gap in GAPS]
            theta = np.concatenate([part.theta for part in low])
            speed = np.concatenate([part.approach for part in low])
            if len(theta):
                x = location(theta)
                rows[damping] = (np.quantile(x, 0.05), np.quantile(x, 0.95), float(speed.mean()))
        text = "; ".join(f"λ = {d:g}: x {a:.2f}-{b:.2f}, {v:.3f}" for d, (a, b, v) in rows.items())
        found = list(rows.values())
        narrower = found[-1][1] - found[-1][0] < found[0][1] - found[0][0]
        harder, higher = found[-1][2] > found[0][2], found[-1][0] > found[0][0]
        return Found(
            f"5 to 95 % of the lower impacts, mean velocity: {text}", met_if(narrower and harder and higher)
        )

    return in_both_forms(
        "lower-wall-trend",
        "4.4",
        "As λ increases the impacts on the lower wall become more limited in place, more severe, and shift "
        "to the head end",
        judge,
        "all gaps together; first against last λ with such impacts",
    )


def lower_region(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        rows = []
        for share in (0.2, 0.6, 0.95):
            damping = share * limits(form)[0]
            found = pressed(Machine(damping, 0.01, form=form), LOWER)
            rows.append((damping, *max(found, key=lambda interval: interval.end - interval.start)))
        text = "; ".join(f"λ = {d:.3f}: {a:.2f}-{b:.2f}" for d, a, b in rows)
        middles = [0.5 * (a + b) for _, a, b in rows]
        from_zero = [abs(middle - TURN * round(middle / TURN)) for middle in middles]
        sizes = [b - a for _, a, b in rows]
        return Found(
            f"(ρ = 0.01) largest interval pressed to the lower wall: {text}; the middle is "
            f"{from_zero[0]:.2f}, then {from_zero[-1]:.2f} from θ = 0",
            met_if(sizes == sorted(sizes, reverse=True) and from_zero == sorted(from_zero, reverse=True)),
            {"first_size": sizes[0], "last_size": sizes[-1], "last_middle": middles[-1]},
        )

    return in_both_forms(
        "lower-region",
        "4.4",
        "As λ increases, the region where the moment presses to the lower wall becomes smaller and moves "
        "towards θ = 0",
        judge,
        "barely: where it vanishes it is still more than 1 rad from θ = 0",
    )


def lower_threshold(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        values = [limits(form, gap)[1] for gap in GAPS]
        text = ", ".join(f"{value:.4f}" for value in values)
        return Found(
            f"λ = {text} at ρ = 0.010, 0.015, 0.020",
            met_if(bool(np.all(np.diff(values) != 0.0))),
            {f"at_{gap:g}": value for gap, value in zip(GAPS, values, strict=True)},
        )

    return in_both_forms(
        "lower-threshold",
        "4.4",
        "Beyond a critical λ, depending on ρ, no net moment pushes to the lower wall at any crank angle",
        judge,
    )


CHECKS: tuple[Check, ...] = (no_lower_impacts, lower_wall_trend, lower_region, lower_threshold)
