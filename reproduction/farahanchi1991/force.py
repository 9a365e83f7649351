"""F 2.6 and 4.4: the forces of the walls on a sliding roller, and where they can hold it."""

import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from models.core.quantities import Vector
from models.slider_crank.equations import (
    Crank,
    joint_rate,
    thesis_mechanism,
    wall_acceleration,
    wall_angle,
    wall_rate,
)
from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.motions.histories import LIFT
from models.slider_crank.motions.machine import Machine, Motion
from models.slider_crank.motions.regions import (
    TURN,
    Interval,
    force_zeros,
    holding_intervals,
    region,
    thresholds,
    wall_forces,
)

from ..statement import Values
from .derivation import evaluate_printed
from .runs import GAPS, PUBLISHED, Runs

# F's figures and their regions.
REGIONS = {
    "2.4": (0.01, 0.01, "I"), "2.5": (0.1, 0.01, "I"), "2.6": (0.25, 0.01, "I"),
    "2.7": (0.267, 0.02, "II"), "2.9": (0.35, 0.01, "III"),
}  # fmt: skip


def compute_curve(machine: Machine, side: float, samples: int = 721) -> Vector:
    """The force over one revolution, both ends included."""
    return wall_forces(machine, side, np.linspace(0.0, TURN, samples))


def can_hold(machine: Machine, side: float, theta: float) -> bool:
    """True if that wall can hold the roller at this crank angle."""
    return bool(wall_forces(machine, side, np.array([theta]))[0] > 0.0)


@lru_cache(maxsize=256)
def find_changes(machine: Machine, side: float) -> tuple[float, ...]:
    """Crank angles in [0, 2 pi) at which the force is zero."""
    return tuple(float(angle) for angle in force_zeros(machine, side))


def find_pressed(machine: Machine, side: float) -> list[Interval]:
    """Where the roller may slide; an interval that passes 2 pi is given with a negative start."""
    found = [
        Interval(a - TURN, b - TURN) if b > TURN and a > 0.0 else Interval(a, b)
        for a, b in holding_intervals(machine, side)
    ]
    return sorted(found)


def measure_shares(machine: Machine) -> dict[str, float]:
    """Radians of crank in which the roller may slide on the upper wall only, lower only, both, neither."""
    edges = sorted({0.0, TURN, *find_changes(machine, UPPER), *find_changes(machine, LOWER)})
    found = {"upper": 0.0, "lower": 0.0, "both": 0.0, "neither": 0.0}
    for a, b in pairwise(edges):
        up, low = (can_hold(machine, side, 0.5 * (a + b)) for side in (UPPER, LOWER))
        found["both" if up and low else "upper" if up else "lower" if low else "neither"] += b - a
    return found


@lru_cache(maxsize=64)
def find_limits(form: str, gap: float = 0.0) -> tuple[float, float]:
    """lambda from which the upper wall holds throughout, and from which the lower one holds nowhere."""
    found = thresholds(Machine(gap=gap, form=form))
    return found.upper, found.lower


def _format_intervals(pairs: Sequence[tuple[float, float]]) -> str:
    return ", ".join(f"{a:.3f}-{b:.3f}" for a, b in pairs) or "nowhere"


def compare_restitutions(runs: Runs) -> Values:
    """Largest difference of the forces with e = 0, 0.5 and 1."""
    values = [compute_curve(Machine(0.1, 0.01, e, PUBLISHED), UPPER, 361) for e in (0.0, 0.5, 1.0)]
    return {"spread": np.ptp(values, axis=0).max()}


def check_symmetry(runs: Runs, form: str, damping: float, gap: float, half_turn: bool) -> Values:
    """What is missing of f_u = -f_l, or of f_u(theta + pi) = -f_u(theta), over the largest force."""
    machine = Machine(damping, gap, form=form)
    upper = compute_curve(machine, UPPER, 721)[:-1]
    other = np.roll(upper, -360) if half_turn else compute_curve(machine, LOWER, 721)[:-1]
    return {"fault": np.abs(upper + other).max() / np.abs(upper).max()}


def divide_turn(runs: Runs, form: str) -> Values:
    found = measure_shares(Machine(0.1, 0.01, form=form))
    return {"each": [f"{name} {value:.4f}" for name, value in found.items()], "least": min(found.values())}


def find_changes_of_sign(runs: Runs, form: str) -> Values:
    """`off`: how far the changes are from pi and 2 pi, infinite where there are not two of them."""
    machine = Machine(0.01, 0.01, form=form)
    up, low = find_changes(machine, UPPER), find_changes(machine, LOWER)
    ends = [*zip(up, (math.pi, TURN), strict=False), *zip(low, (math.pi, TURN), strict=False)]
    return {
        "upper_changes": len(up), "lower_changes": len(low),
        "upper": _format_intervals(find_pressed(machine, UPPER)),
        "lower": _format_intervals(find_pressed(machine, LOWER)),
        "off": max(abs(a - b) for a, b in ends) if len(up) == len(low) == 2 else math.inf,
    }  # fmt: skip


def compare_dampings(runs: Runs, form: str) -> Values:
    machines = [Machine(damping, 0.01, form=form) for damping in (0.01, 0.1, 0.25)]
    found = [measure_shares(machine) for machine in machines]
    grows = bool(np.all(np.diff([compute_curve(machine, UPPER, 361) for machine in machines], axis=0) > 0.0))
    return {
        "spans": [one["upper"] + one["both"] for one in found],
        "grows": grows, "where": "every angle" if grows else "not every angle",
    }  # fmt: skip


def compare_gaps(runs: Runs, form: str) -> Values:
    machines = [Machine(0.1, gap, form=form) for gap in (0.0, 0.01, 0.02)]
    return {
        "sums": [np.abs(compute_curve(m, UPPER, 361) + compute_curve(m, LOWER, 361)).max() for m in machines]
    }


def find_holding_intervals(runs: Runs, form: str) -> Values:
    """Where the walls can hold the roller; the lower one's first interval."""
    machine = Machine(0.267, 0.02, form=form)
    low, upper_changes = find_pressed(machine, LOWER), len(find_changes(machine, UPPER))
    begin, end = low[0] if low else (math.inf, math.inf)
    return {
        "upper": _format_intervals(find_pressed(machine, UPPER)) if upper_changes else "the whole turn",
        "lower": _format_intervals(low), "upper_changes": upper_changes, "begin": begin, "end": end,
        "mixed": _find_mixed_interval(),
    }  # fmt: skip


def _find_mixed_interval() -> tuple[float, float]:
    """Where the lower wall's force of (2.29), not linearized, at the linear walls is positive."""
    m = thesis_mechanism(0.267)

    def compute_moment(theta: float) -> float:
        psi = wall_angle(theta, -0.02, m.xi)
        rate = wall_rate(theta, 1.0, psi, m.xi)
        bend = wall_acceleration(Crank(theta, 1.0, 0.0), psi, m.xi)
        return evaluate_printed(theta, psi, bend, m) - m.damping * joint_rate(theta, 1.0, rate, m)

    return float(brentq(compute_moment, 4.85, 5.05)), float(brentq(compute_moment, 5.05, 5.25))


def measure_crossings(runs: Runs, form: str) -> Values:
    """Over pairs (lambda, rho) with crossings: radians in which either wall holds the roller, and neither."""
    pairs = [(d, gap) for d in np.linspace(0.01, 0.25, 9) for gap in (0.005, 0.01, 0.02)]
    machines = [Machine(float(damping), gap, form=form) for damping, gap in pairs]
    found = [
        measure_shares(m) for m in machines if min(len(find_changes(m, side)) for side in (UPPER, LOWER)) >= 2
    ]
    if not found:
        return {"words": "no crossings", "least": 0.0, "most": math.inf}
    both, neither = ([one[name] for one in found] for name in ("both", "neither"))
    return {
        "words": f"{len(found)} pairs (λ, ρ) with crossings: either {min(both):.4f}-{max(both):.4f} rad of a "
        f"turn, neither {min(neither):.4f}-{max(neither):.4f}",
        "least": min(*both, *neither), "most": max(*both, *neither),
    }  # fmt: skip


def find_crossings(runs: Runs, form: str) -> Values:
    machine = Machine(0.1, 0.01, form=form)
    pairs = list(zip(find_changes(machine, UPPER), find_changes(machine, LOWER), strict=True))
    return {
        "pairs": _format_intervals([(min(pair), max(pair)) for pair in pairs]),
        "kinds": ["either" if can_hold(machine, UPPER, 0.5 * sum(pair)) else "neither" for pair in pairs],
    }


def count_releases(runs: Runs, form: str) -> Values:
    machine = Machine(0.35, 0.01, form=form)
    return {
        "least": compute_curve(machine, UPPER, 721).min(),
        "releases": int(np.sum(Motion(machine).skip(100).events(100).kind == LIFT)),
    }


def assign_regions(runs: Runs, form: str) -> Values:
    found = {name: region(Machine(d, gap, form=form)) for name, (d, gap, _) in REGIONS.items()}
    return {
        "each": [f"Fig. {name}: {where}" for name, where in found.items()],
        "right": all(found[name] == stated for name, (_, _, stated) in REGIONS.items()),
    }


def find_thresholds(runs: Runs, form: str) -> Values:
    """lambda from which the upper wall holds throughout and from which the lower one holds nowhere."""
    first, second = find_limits(form, 0.02)
    return {"zero": find_limits(form)[0], "first": first, "second": second,
            "lower": [find_limits(form, gap)[1] for gap in GAPS]}  # fmt: skip


def follow_lower_region(runs: Runs, form: str) -> Values:
    """Largest interval pressed to the lower wall at rho = 0.01: its size and its distance from theta = 0."""
    rows = []
    for share in (0.2, 0.6, 0.95):
        damping = share * find_limits(form)[0]
        found = find_pressed(Machine(damping, 0.01, form=form), LOWER)
        rows.append((damping, *max(found, key=lambda interval: interval.end - interval.start)))
    middles = [0.5 * (a + b) for _, a, b in rows]
    return {
        "each": "; ".join(f"λ = {d:.3f}: {a:.2f}-{b:.2f}" for d, a, b in rows),
        "sizes": [b - a for _, a, b in rows],
        "from_zero": [abs(middle - TURN * round(middle / TURN)) for middle in middles],
    }
