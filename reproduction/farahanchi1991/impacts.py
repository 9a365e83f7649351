"""F chapter 4: records of impacts, over the walls and their velocities."""

import math

import numpy as np

from models.slider_crank.equations import THESIS_XI
from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.motions.classification import CHAOTIC
from models.slider_crank.motions.machine import Events
from models.slider_crank.motions.statistics import impact_profile, uniformity

from ..statement import Values, is_rising
from .runs import (
    CYCLES,
    GAPS,
    HIGH_DAMPINGS,
    LOW_DAMPINGS,
    MATRIX,
    Case,
    Runs,
    list_cases,
    observe,
)

# Parts of a wall.
BINS = 50


def select_wall(events: Events, side: float) -> Events:
    """The impacts on that wall."""
    impacts = events.impacts
    return impacts.where(impacts.side == side)


def average_approach(events: Events) -> float:
    """Mean velocity of approach, over l Omega; 0 without impacts."""
    return float(events.approach.mean()) if len(events.approach) else 0.0


def measure_spread(events: Events) -> float:
    """Uniformity of the velocities of approach along the walls, their mean weighed by the walls' shares of
    it: 1 even, 0 in one spot, nan without impacts."""
    profile = impact_profile(events.impacts, events.impacts.approach, THESIS_XI, BINS, 1)
    used = [wall for wall in (profile.upper, profile.lower) if wall.sum() > 0.0]
    if not used:
        return math.nan
    return float(np.average([uniformity(wall) for wall in used], weights=[wall.sum() for wall in used]))


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
    """Velocities of an impact on both walls by lambda, means over rho."""
    up, low, wrong = [], [], []
    for row in _list_by_gap(dampings, form).values():
        parts = [[select_wall(runs.events(case), side) for case in row] for side in (UPPER, LOWER)]
        means = [[average_approach(part) for part in wall] for wall in parts]
        wrong += [str(case) for case, a, b in zip(row, *means, strict=True) if a <= b]
        up.append(float(np.mean(means[0])))
        low.append(float(np.mean(means[1])))
    return {
        "pairs": "; ".join(f"{a:.4f} and {b:.4f}" for a, b in zip(up, low, strict=True)),
        "differences": [a - b for a, b in zip(up, low, strict=True)],
        "gaps": [abs(a - b) for a, b in zip(up, low, strict=True)],
        "wrong": ", ".join(wrong) or "none",
    }  # fmt: skip


def count_lower(runs: Runs, form: str) -> Values:
    """Impacts on the lower wall in 300 cycles at large friction."""
    cases = [Case(damping, gap, form=form) for damping in (0.25, 0.26, 0.28, 0.35) for gap in GAPS]
    return {"count": sum(len(select_wall(runs.events(case, 300), LOWER).theta) for case in cases)}
