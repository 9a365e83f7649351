"""F chapters 3 and 4: records of impacts, over the walls and their velocities."""

import math

import numpy as np

from models.core.quantities import Vector
from models.slider_crank.equations import THESIS_XI
from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.motions.classification import CHAOTIC
from models.slider_crank.motions.machine import Events
from models.slider_crank.motions.statistics import impact_profile, uniformity, wall_position

from ..statement import Values, is_rising
from .runs import (
    CYCLES,
    GAPS,
    HIGH_DAMPINGS,
    LOW_DAMPINGS,
    MATRIX,
    TRANSIENT,
    Case,
    Runs,
    list_cases,
    observe,
)

# Parts of a wall.
BINS = 50
SLIDING, EXAMPLE = Case(0.25, 0.015), Case(0.05, 0.01)
# A very small velocity: a tenth of the mean.
SLOW = 0.004


def select_wall(events: Events, side: float) -> Events:
    """The impacts on that wall."""
    impacts = events.impacts
    return impacts.where(impacts.side == side)


def average_approach(events: Events) -> float:
    """Mean velocity of approach, over l Omega; 0 without impacts."""
    return float(events.approach.mean()) if len(events.approach) else 0.0


def compute_profile(events: Events, side: float, cycles: int) -> Vector:
    """Velocities of approach per cycle in equal parts of one wall."""
    impacts = events.impacts
    found = impact_profile(impacts, impacts.approach, THESIS_XI, BINS, cycles)
    return found.upper if side == UPPER else found.lower


def measure_spread(events: Events) -> float:
    """Uniformity of the velocities of approach along the walls, their mean weighed by the walls' shares of
    it: 1 even, 0 in one spot, nan without impacts."""
    walls = [compute_profile(events, side, 1) for side in (UPPER, LOWER)]
    used = [wall for wall in walls if wall.sum() > 0.0]
    if not used:
        return math.nan
    return float(np.average([uniformity(wall) for wall in used], weights=[wall.sum() for wall in used]))


def count_backward(runs: Runs, form: str) -> Values:
    """Upper impacts with psi' <= 0."""
    rates = np.concatenate([select_wall(runs.events(c), UPPER).rate for c in list_cases(LOW_DAMPINGS, form)])
    return {"backward": int(np.sum(rates <= 0.0)), "total": rates.size, "least": rates.min()}


def locate_stroke(runs: Runs) -> Values:
    """Places at crank angles 0, pi/2 and pi, and how far the ends are from 1 +- xi."""
    head, middle, end = wall_position(np.array([0.0, 0.5 * math.pi, math.pi]), THESIS_XI)
    off = max(abs(head - 1.0 - THESIS_XI), abs(end - 1.0 + THESIS_XI))
    return {"head": head, "middle": middle, "crank_end": end, "off": off}


def average_profile(runs: Runs, form: str) -> Values:
    events = runs.events(EXAMPLE.in_form(form)).impacts
    bars = impact_profile(events, np.abs(events.rate), THESIS_XI, BINS, len(events.rate))
    return {"sum": bars.upper.sum() + bars.lower.sum(), "mean": np.abs(events.rate).mean()}


def sum_velocities(runs: Runs) -> Values:
    """Impacts and velocities per cycle, exactly and by F's threshold of sliding."""
    both = [runs.events(case).impacts for case in (SLIDING, SLIDING.by_thesis_rule)]
    return {
        "counts": [len(events.theta) / CYCLES for events in both],
        "sums": [np.abs(events.approach).sum() / CYCLES for events in both],
    }


def compare_records(runs: Runs, form: str) -> Values:
    """How far profiles of 3000 and 12000 cycles are from that of a long record."""
    events = runs.motion(Case(0.025, 0.02, form=form)).events(64 * CYCLES)

    def compute_upper(cycles: int) -> Vector:
        return compute_profile(events.where(events.cycle < TRANSIENT + cycles), UPPER, cycles)

    long = compute_upper(64 * CYCLES)
    return {"errors": [np.abs(compute_upper(n * CYCLES) - long).sum() / long.sum() for n in (1, 4)]}


def split_directions(runs: Runs, form: str) -> Values:
    """Shares of the upper impacts on the way from the head and back."""
    out = np.mean(select_wall(runs.events(EXAMPLE.in_form(form)), UPPER).theta < math.pi)
    return {"out": out, "back": 1.0 - out}


def measure_uniformity(runs: Runs, form: str) -> Values:
    """Uniformity of the velocities over the walls, of chaotic motions and of others."""
    found = {case: measure_spread(runs.final(case)) for case in list_cases(MATRIX, form)}
    kinds: tuple[list[float], list[float]] = ([], [])
    for case, value in found.items():
        if value == value:
            kinds[observe(runs, case).kind != CHAOTIC].append(value)
    chaotic, other = kinds
    ranges = [f"{min(values):.2f}-{max(values):.2f}" if values else "none" for values in kinds]
    return {
        "bins": BINS, "chaotic": ranges[0], "other": ranges[1],
        "least_chaotic": min(chaotic, default=math.nan), "most_other": max(other, default=math.nan),
    }  # fmt: skip


def measure_background(runs: Runs, form: str) -> Values:
    """The share of impacts during the transient, after F's 30 cycles, in 1500 cycles and in 3000."""
    case = Case(0.075, 0.01, form=form)
    length = runs.kind(case).transient
    records = [runs.events(case, cycles).impacts for cycles in (1500, CYCLES)]
    return {"length": length, "shares": [np.mean(events.cycle < length) for events in records]}


def _format_rows(values: dict[float, list[float]], form: str) -> str:
    return "; ".join(f"λ = {d:g}: {', '.join(format(v, form) for v in row)}" for d, row in values.items())


def _list_by_gap(dampings: tuple[float, ...], form: str) -> dict[float, list[Case]]:
    return {damping: [Case(damping, gap, form=form) for gap in GAPS] for damping in dampings}


def compare_gaps(runs: Runs, form: str) -> Values:
    """Mean velocities, and radians of crank between impacts, at small friction."""
    rows = {d: [runs.events(c).impacts for c in row] for d, row in _list_by_gap(LOW_DAMPINGS, form).items()}
    speeds = {d: [average_approach(events) for events in row] for d, row in rows.items()}
    flights = {d: [2.0 * np.pi * CYCLES / len(e.theta) for e in row] for d, row in rows.items()}
    return {
        "speeds": _format_rows(speeds, ".4f"), "flights": _format_rows(flights, ".2f"),
        "faster": all(is_rising(row) for row in speeds.values()),
        "longer": all(row[-1] > row[0] for row in flights.values()),
    }  # fmt: skip


def find_fastest(runs: Runs, form: str) -> Values:
    """Largest velocities at large friction."""
    rows = {
        damping: [float(runs.events(case).impacts.approach.max(initial=0.0)) for case in row]
        for damping, row in _list_by_gap(HIGH_DAMPINGS, form).items()
    }
    return {"each": _format_rows(rows, ".3f"), "rising": all(is_rising(row) for row in rows.values())}


def compare_walls(runs: Runs, form: str, dampings: tuple[float, ...]) -> Values:
    """Velocities on the walls by lambda, means over rho: of an impact, and in all of a cycle."""
    up, low, ratios, wrong = [], [], [], []
    for row in _list_by_gap(dampings, form).values():
        parts = [[select_wall(runs.events(case), side) for case in row] for side in (UPPER, LOWER)]
        means = [[average_approach(part) for part in wall] for wall in parts]
        wrong += [str(case) for case, a, b in zip(row, *means, strict=True) if a <= b]
        up.append(float(np.mean(means[0])))
        low.append(float(np.mean(means[1])))
        sums = [sum(float(part.approach.sum()) / CYCLES for part in wall) for wall in parts]
        ratios.append(sums[0] / sums[1] if sums[1] else math.inf)
    return {
        "pairs": "; ".join(f"{a:.4f} and {b:.4f}" for a, b in zip(up, low, strict=True)),
        "differences": [a - b for a, b in zip(up, low, strict=True)],
        "gaps": [abs(a - b) for a, b in zip(up, low, strict=True)],
        "ratios": ratios, "wrong": ", ".join(wrong) or "none",
    }  # fmt: skip


def find_slowest(runs: Runs, form: str) -> Values:
    """The slowest impact of each case."""
    least = {case: runs.events(case).impacts.approach.min() for case in list_cases(LOW_DAMPINGS, form)}
    without = [str(case) for case, value in least.items() if value > SLOW]
    return {
        "slow": len(least) - len(without), "cases": len(least), "limit": SLOW,
        "low": min(least.values()), "high": max(least.values()),
        "others": f"; not {', '.join(without)}" if without else "",
    }  # fmt: skip


def count_descending(runs: Runs, form: str) -> Values:
    """Upper impacts that follow another in the same cycle, and the share that is slower than it."""
    events = runs.events(EXAMPLE.in_form(form)).impacts
    pairs = (events.side[:-1] == UPPER) & (events.side[1:] == UPPER) & (events.cycle[:-1] == events.cycle[1:])
    return {"pairs": int(pairs.sum()), "slower": np.mean(events.rate[1:][pairs] < events.rate[:-1][pairs])}


def count_lobes(runs: Runs, form: str) -> Values:
    """Separate ranges of crank angle, to half a degree, that hold upper impacts."""
    case = EXAMPLE.in_form(form)
    if runs.kind(case).period:
        return {"words": "a finite set of points in the end", "lobes": 0}
    theta = select_wall(runs.events(case), UPPER).theta
    filled = np.histogram(theta, 720, (0.0, 2.0 * math.pi))[0] > 0
    count = int(np.sum(filled & ~np.roll(filled, 1)))
    return {"words": f"{count} separate ranges of crank angle hold all upper impacts", "lobes": count}


def count_lower(runs: Runs, form: str) -> Values:
    """Impacts on the lower wall in 300 cycles at large friction."""
    cases = [Case(damping, gap, form=form) for damping in (0.25, 0.26, 0.28, 0.35) for gap in GAPS]
    return {"count": sum(len(select_wall(runs.events(case, 300), LOWER).theta) for case in cases)}


def follow_lower(runs: Runs, form: str) -> Values:
    """Where the lower wall is hit (5 and 95 % of the places) and how hard, all gaps together."""
    rows = {}
    for damping, row in _list_by_gap((*LOW_DAMPINGS, 0.15, 0.20), form).items():
        parts = [select_wall(runs.events(case), LOWER) for case in row]
        if x := np.concatenate([wall_position(part.theta, THESIS_XI) for part in parts]).tolist():
            speed = np.concatenate([part.approach for part in parts])
            rows[damping] = (np.quantile(x, 0.05), np.quantile(x, 0.95), speed.mean())
    first, *_, last = rows.values()
    return {
        "each": "; ".join(f"λ = {d:g}: x {a:.2f}-{b:.2f}, {v:.3f}" for d, (a, b, v) in rows.items()),
        "narrower": last[1] - last[0] < first[1] - first[0], "harder": last[2] > first[2],
        "higher": last[0] > first[0],
    }  # fmt: skip
