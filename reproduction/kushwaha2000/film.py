"""Section 5, Figs 4, 5 and 7: film thickness and squeeze velocity."""

import math
from functools import cache

import numpy as np

from ..statement import Values
from .runs import AS_PRINTED, NEGATIVE, NOSE_DEG, SPEEDS, Cycle, Runs

STATED_MINIMUM, STATED_NOSE, STATED_MAXIMUM, STATED_TRANSIT = 0.04e-6, 1.0e-6, 1.3e-6, 1e-3
LOW_SPEED = 100.0
DEGREES_PER_SECOND = 6.0  # per r/min
# Where u peaks on the flank.
FLANK_DEG = 113.0


def _find_minima(runs: Runs, cycle: Cycle) -> list[int]:
    """Index of the least film within 6 degrees of each reversal."""
    return [
        int(np.argmin(np.where(np.abs(cycle.angle_deg - angle) <= 6.0, cycle.film, np.inf)))
        for angle in runs.reversals_deg
    ]


@cache
def find_minima(runs: Runs) -> Values:
    """The least films near the reversals of the kinematic cycle."""
    cycle = runs.kinematic()
    found = _find_minima(runs, cycle)
    lags = cycle.angle_deg[found] - runs.reversals_deg
    doubled = [i + np.argmax(cycle.film[i:] >= 2.0 * cycle.film[i]) for i in found]
    times, first, last = cycle.time[doubled] - cycle.time[found], found[0], found[-1]
    transit, span = cycle.time[last] - cycle.time[first], cycle.angle_deg[last] - cycle.angle_deg[first]
    return {
        "films": [cycle.film_at(a) for a in runs.reversals_deg],
        "least_lag": min(lags), "largest_lag": max(lags),
        "least_time": min(times), "largest_time": max(times),
        "transit": transit, "span_deg": span, "twice": 2.0 * transit,
        "needed_rpm": span / DEGREES_PER_SECOND / STATED_TRANSIT,
    }  # fmt: skip


@cache
def measure_films(runs: Runs) -> Values:
    """Films of the kinematic cycle by (10) with either exponent, and the speeds that the stated ones need."""
    printed, negative = runs.kinematic(), runs.kinematic(film=NEGATIVE)
    slower = [runs.kinematic(speed) for speed in (LOW_SPEED, *SPEEDS)]
    speeds = np.log((LOW_SPEED, *SPEEDS))

    def find_speed(level: float, films: list[float]) -> float:
        """Cam speed (r/min), log-log between the computed ones."""
        return float(np.exp(np.interp(math.log(level), np.log(films), speeds)))

    ratios = [c.film.max() / c.film_at(NOSE_DEG) for c in (runs.surge(speed) for speed in SPEEDS)]
    return {
        "least": printed.film.min(), "least_negative": negative.film.min(),
        "least_needs": find_speed(STATED_MINIMUM, [c.film.min() for c in slower]),
        "nose": printed.film_at(NOSE_DEG), "nose_negative": negative.film_at(NOSE_DEG),
        "nose_needs": find_speed(STATED_NOSE, [c.film_at(NOSE_DEG) for c in slower]),
        "largest": printed.film.max(), "largest_negative": negative.film.max(),
        "ratio_low": min(ratios), "ratio_high": max(ratios),
        "ratio_negative": negative.film.max() / negative.film_at(NOSE_DEG),
        "stated_ratio": STATED_MAXIMUM / STATED_NOSE,
        "slow_rpm": LOW_SPEED, "slow_least": slower[0].film.min(), "slow_nose": slower[0].film_at(NOSE_DEG),
    }  # fmt: skip


def measure_squeeze(runs: Runs) -> Values:
    """Squeeze velocity of the kinematic cycle and its part in the film."""
    cycle, other = runs.kinematic(), runs.kinematic(film=NEGATIVE).squeeze
    ends = runs.reversals_deg[0], runs.reversals_deg[-1]
    film, steady = (
        cycle.between(f"contact.{name}", *ends) for name in ("film_thickness", "steady_film_thickness")
    )
    near = _find_minima(runs, cycle)
    added = np.maximum(film - steady, 0.0)
    low, high = int(np.argmin(cycle.squeeze)), int(np.argmax(cycle.squeeze))
    low_off, high_off = (np.abs(cycle.angle_deg[i] - np.array(runs.reversals_deg)).min() for i in (low, high))
    return {
        "share": added.sum() / film.sum(), "mostly": np.mean(added > 0.5 * film),
        "lowest": cycle.squeeze[low], "highest": cycle.squeeze[high],
        "low_off": low_off, "high_off": high_off,
        "negative_lowest": other.min(), "negative_highest": other.max(),
        "correlation": np.corrcoef(np.gradient(cycle.film, cycle.time), cycle.squeeze)[0, 1],
        "approach_first": all(cycle.squeeze[i - 5] < 0.0 < cycle.squeeze[i + 5] for i in near),
    }  # fmt: skip


@cache
def compare_speeds(runs: Runs) -> Values:
    """Films with spring surge: least, on flank and nose over the base circle's, at the reversals."""
    cycles = [runs.surge(speed) for speed in SPEEDS]
    film = "contact.film_thickness"
    flank = [c.between(film, 90.0, 140.0).max() / c.film[0] for c in cycles]
    nose = [c.film_at(NOSE_DEG) / c.film[0] for c in cycles]
    at_rest = np.array([[c.film_at(a) for a in runs.reversals_deg] for c in cycles])
    grown = at_rest[-1] / at_rest[0]
    return {
        "least": [c.film.min() for c in cycles],
        "each_least": [f"{1e6 * c.film.min():.3f} µm at {c.run.speed_rpm:.0f}" for c in cycles],
        "lowest": min(*flank, *nose),
        "flank_and_nose": "; ".join(f"{a:.2f} and {b:.2f}" for a, b in zip(flank, nose, strict=True)),
        "at_rest": list(at_rest.mean(axis=1)), "grown_low": grown.min(), "grown_high": grown.max(),
        "exponent": math.log(np.mean(grown)) / math.log(SPEEDS[-1] / SPEEDS[0]),
    }  # fmt: skip


def separate_load(runs: Runs) -> Values:
    """Film from 1000 to 3000 r/min on the flank, and the load's share in it."""

    def compute_gain(name: str) -> float:
        return runs.surge(3000.0, name).film_at(FLANK_DEG) / runs.surge(1000.0, name).film_at(FLANK_DEG)

    speed, gains = 3.0**0.541, [compute_gain(AS_PRINTED), compute_gain(NEGATIVE)]
    return {
        "deg": FLANK_DEG, "loads": [runs.surge(s).at("contact.load", FLANK_DEG) for s in (1000.0, 3000.0)],
        "gains": gains, "by_load": [value / speed for value in gains], "by_speed": speed,
    }  # fmt: skip
