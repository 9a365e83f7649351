"""F 2.6: the forces of the walls on a sliding roller."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from models.slider_crank.equations import (
    joint_rate,
    thesis_mechanism,
    wall_acceleration,
    wall_angle,
    wall_rate,
)
from models.slider_crank.flight.histories import LIFT
from models.slider_crank.machine import Machine, Motion

from ...statement import Statement, Verdict, met_if
from ..forces import LOWER, TURN, UPPER, changes, curve, in_force, limits, pressed, region, shares
from ..lagrange import printed
from ..runs import Runs
from .judging import Check, Found, in_both_forms

# Read from a printed graph, an angle is good to about so much (rad).
GRAPH = 0.02
# What "approximately" may be about an angle that F names by 0, pi and 2 pi (rad).
ABOUT = 0.15
# F's intervals are "typically small": below this part of a revolution.
SMALL = 0.05
STATED_BOTH = (4.96, 5.14)


def intervals(pairs: list[tuple[float, float]]) -> str:
    return ", ".join(f"{a:.3f}-{b:.3f}" for a, b in pairs) or "nowhere"


def four_regions(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        found = shares(Machine(0.1, 0.01, form=form))
        text = ", ".join(f"{name} {value:.4f}" for name, value in found.items())
        return Found(f"rad of a turn at (0.1, 0.01): {text}", met_if(min(found.values()) > 0.0), found)

    return in_both_forms(
        "four-regions",
        "2.6",
        "There are four kinds of crank angles: sliding on the upper wall only, lower only, either, neither",
        judge,
    )


def figure_2_4(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        machine = Machine(0.01, 0.01, form=form)
        up, low = changes(machine, UPPER), changes(machine, LOWER)
        slides = (
            f"upper wall {intervals(pressed(machine, UPPER))}, lower {intervals(pressed(machine, LOWER))}"
        )
        half = len(up) == len(low) == 2 and max(
            abs(angle - stated)
            for ends in (up, low)
            for angle, stated in zip(ends, (math.pi, TURN), strict=True)
        )
        return Found(
            f"{len(up)} changes of sign on the upper wall, {len(low)} on the lower; may slide: {slides}",
            met_if(0.0 < half < ABOUT),
            {"upper_changes": len(up), "lower_changes": len(low)},
        )

    return in_both_forms(
        "figure-2-4",
        "2.6, Fig. 2.4",
        "(0.01, 0.01): the forces change direction at two crank angles; sliding on the upper wall from "
        "about 0 to π, on the lower from π to 2π",
        judge,
        "the main thing that the sign error hides: with the right sign the wall force changes side four "
        "times a revolution at high speed",
    )


def longer_upper(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        spans = []
        for damping in (0.01, 0.1, 0.25):
            found = shares(Machine(damping, 0.01, form=form))
            spans.append(found["upper"] + found["both"])
        text = ", ".join(f"{span:.3f}" for span in spans)
        forces = [curve(Machine(d, 0.01, form=form), UPPER, 361) for d in (0.01, 0.1, 0.25)]
        grows = bool(np.all(np.diff(forces, axis=0) > 0.0))
        return Found(
            f"rad of a turn at λ = 0.01, 0.1, 0.25: {text}; the force grows at "
            f"{'every angle' if grows else 'not every angle'}",
            met_if(grows and spans[0] < spans[1] <= spans[2]),
            {f"span_{n}": span for n, span in enumerate(spans)},
        )

    return in_both_forms(
        "longer-upper",
        "2.6, Figs. 2.4-2.6",
        "As λ increases, the force on the upper wall increases and its sliding region is extended (ρ = 0.01)",
        judge,
    )


def asymmetry(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        sums = []
        for gap in (0.0, 0.01, 0.02):
            machine = Machine(0.1, gap, form=form)
            sums.append(float(np.abs(curve(machine, UPPER, 361) + curve(machine, LOWER, 361)).max()))
        text = ", ".join(f"{value:.5f}" for value in sums)
        return Found(
            f"largest |f_u + f_l| at ρ = 0, 0.01, 0.02: {text}",
            met_if(sums[0] < 1e-12 < sums[1] < sums[2]),
            {f"sum_{n}": value for n, value in enumerate(sums)},
        )

    return in_both_forms(
        "asymmetry", "2.6", "f_u = −f_l only for ρ = 0; f_u + f_l deviates from zero as ρ increases", judge
    )


def figure_2_7(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        machine = Machine(0.267, 0.02, form=form)
        low, up = pressed(machine, LOWER), changes(machine, UPPER)
        near = bool(low) and all(
            abs(value - stated) < GRAPH for value, stated in zip(low[0], STATED_BOTH, strict=True)
        )
        values = {"begin": low[0][0], "end": low[0][1]} if low else {}
        return Found(
            f"upper wall {'the whole turn' if not up else intervals(pressed(machine, UPPER))}, lower wall "
            f"{intervals(low)}",
            met_if(near and not up),
            values,
        )

    mixed = mixed_interval()
    return in_both_forms(
        "figure-2-7",
        "2.6, Fig. 2.7",
        "λ = 0.267, ρ = 0.02: upper wall over the entire cycle, and the lower too for 4.96 < θ < 5.14",
        judge,
        "to what can be read from a graph; (2.29) taken with cos(φ−ψ), not linearized, at F's linear "
        f"walls, as the text has it, gives {mixed[0]:.3f}-{mixed[1]:.3f}, nearer to the printed numbers: "
        "the force was drawn from the equation before its linearization",
    )


def mixed_interval() -> tuple[float, float]:
    """Where the lower wall's force of (2.29), not linearized, at the linear walls is positive."""
    m = thesis_mechanism(0.267)

    def pushing(theta: float) -> float:
        psi = wall_angle(theta, -0.02, m.xi)
        rate = wall_rate(theta, 1.0, psi, m.xi)
        bend = wall_acceleration(theta, 1.0, 0.0, psi, m.xi)
        return printed(theta, psi, bend, m) - m.damping * joint_rate(theta, 1.0, rate, m)

    return float(brentq(pushing, 4.85, 5.05)), float(brentq(pushing, 5.05, 5.25))


def near_crossings(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        both, neither, cases = [], [], 0
        for damping in np.linspace(0.01, 0.25, 9):
            for gap in (0.005, 0.01, 0.02):
                machine = Machine(float(damping), gap, form=form)
                if len(changes(machine, UPPER)) < 2 or len(changes(machine, LOWER)) < 2:
                    continue
                cases += 1
                found = shares(machine)
                both.append(found["both"])
                neither.append(found["neither"])
        if not cases:
            return Found("no crossings", Verdict.NOT_MET)
        good = min(*both, *neither) > 0.0
        return Found(
            f"{cases} pairs (λ, ρ) with crossings: either {min(both):.4f}-{max(both):.4f} rad of a turn, "
            f"neither {min(neither):.4f}-{max(neither):.4f}",
            met_if(good and max(*both, *neither) < SMALL * TURN),
            {"largest_both": max(both), "largest_neither": max(neither), "least": min(*both, *neither)},
        )

    return in_both_forms(
        "near-crossings",
        "2.6, Fig. 2.8",
        "At the crossing that continues θ = π either wall can hold the roller, at that of 2π neither, for "
        "all (λ, ρ) with crossings; the intervals are typically small",
        judge,
    )


def figure_2_8(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        machine = Machine(0.1, 0.01, form=form)
        up, low = changes(machine, UPPER), changes(machine, LOWER)
        pairs = ", ".join(f"{min(a, b):.3f}-{max(a, b):.3f}" for a, b in zip(up, low, strict=True))
        kinds = [
            "either" if in_force(machine, UPPER, 0.5 * (a + b)) else "neither"
            for a, b in zip(up, low, strict=True)
        ]
        return Found(
            f"{pairs} ({', '.join(kinds)})",
            met_if(kinds == ["either", "neither"]),
            {f"{kind}_{n}": abs(a - b) for n, (kind, a, b) in enumerate(zip(kinds, up, low, strict=True))},
        )

    return in_both_forms(
        "figure-2-8",
        "2.6, Fig. 2.8",
        "(0.1, 0.01): first an interval with sliding on either wall, then one with sliding on neither",
        judge,
    )


def figure_2_9(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        machine = Machine(0.35, 0.01, form=form)
        motion = Motion(machine).skip(100)
        lifts = int(np.sum(motion.events(100).kind == LIFT))
        low = float(curve(machine, UPPER, 721).min())
        return Found(
            f"least force {low:.4f}; {lifts} releases in 100 cycles",
            met_if(low > 0.0 and lifts == 0),
            {"least": low, "releases": lifts},
        )

    return in_both_forms(
        "figure-2-9",
        "2.6, Fig. 2.9",
        "λ = 0.35: the roller may slide along the upper wall throughout the cycle and will never release",
        judge,
        "F does not give the figure's ρ; 0.01 taken",
    )


def figure_2_10(runs: Runs) -> Statement:
    examples = {
        "2.4": (0.01, 0.01, "I"), "2.5": (0.1, 0.01, "I"), "2.6": (0.25, 0.01, "I"),
        "2.7": (0.267, 0.02, "II"), "2.9": (0.35, 0.01, "III"),
    }  # fmt: skip

    def judge(form: str) -> Found:
        found = {name: region(Machine(d, g, form=form)) for name, (d, g, _) in examples.items()}
        right = all(found[name] == stated for name, (_, _, stated) in examples.items())
        return Found(", ".join(f"Fig. {name}: {where}" for name, where in found.items()), met_if(right))

    return in_both_forms(
        "figure-2-10",
        "2.6, Fig. 2.10",
        "Regions: I for Figs. 2.4, 2.5, 2.6; II for Fig. 2.7; III for Fig. 2.9",
        judge,
    )


def thresholds(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        zero, _ = limits(form)
        first, second = limits(form, 0.02)
        ordered = first < zero < second
        return Found(
            f"λ = {zero:.5f} as ρ → 0; at ρ = 0.02 I ends at {first:.5f} and III begins at {second:.5f}",
            met_if(ordered),
            {"threshold": zero, "end_of_i": first, "begin_of_iii": second},
        )

    return in_both_forms(
        "thresholds",
        "2.6, Fig. 2.10",
        "Region II lies between I and III and grows with ρ",
        judge,
        "with the right sign less than half of the friction holds the roller on the upper wall for good, "
        "or the same friction up to more than twice the crank speed (λ ∝ 1/Ω)",
    )


REGIONS: tuple[Check, ...] = (four_regions,)
CHECKS: tuple[Check, ...] = (
    figure_2_4,
    longer_upper,
    asymmetry,
    figure_2_7,
    near_crossings,
    figure_2_8,
    figure_2_9,
    figure_2_10,
    thresholds,
)
