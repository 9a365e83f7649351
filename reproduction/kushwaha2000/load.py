"""Section 5, Figs 6 and 8: the contact load with spring surge and with a flexible camshaft."""

import math
from functools import cache

import numpy as np

from models.core.quantities import Vector
from models.monolithic import solve
from models.valve_train.shaft_element import shaft_element
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start

from ..statement import Values, rms
from .parts import compute_bending_rate
from .runs import FLEXIBLE_SPEED, INTERVALS, NOSE_DEG, SPEEDS, Cycle, Runs, read_parameters

# Before and after the nose, far from it and near to it.
SPANS = {
    "90-120": (93.0, 120.0),
    "150-177": (150.0, 177.0),
    "183-210": (183.0, 210.0),
    "240-267": (240.0, 267.0),
}


@cache
def compare_speeds(runs: Runs) -> Values:
    """Loads with spring surge: extremes, on the flank, at the reversals; and what surge changes."""
    cycles = [runs.surge(speed) for speed in SPEEDS]
    at_rest = {a: [c.at("contact.load", a) for c in cycles] for a in runs.reversals_deg}
    return {
        "least": [c.load.min() for c in cycles], "largest": [c.load.max() for c in cycles],
        "flank": [c.between("contact.load", 90.0, 134.0).max() for c in cycles],
        "at_rest": "; ".join(f"{a:.0f}°: {', '.join(f'{v:.0f}' for v in row)}" for a, row in at_rest.items()),
        "changed": [rms(c.load - runs.kinematic(c.run.speed_rpm).load) for c in cycles],
        "flexible_least": runs.flexible(SPEEDS[-1]).load.min(),
        "preload": runs.parameters("valve_spring").preload,
    }  # fmt: skip


def measure_surge(runs: Runs) -> Values:
    """What surge changes at 3000 r/min where the load is low and where it is high."""
    plain = runs.kinematic(3000.0).load
    change, low = runs.surge(3000.0).load - plain, plain < np.median(plain) * (1.0 + 1e-9)
    return {
        "low": rms(change[low]), "high": rms(change[~low]),
        "low_share": rms(change[low] / plain[low]), "high_share": rms(change[~low] / plain[~low]),
    }  # fmt: skip


def find_crossings(runs: Runs) -> Values:
    """Cam angles from the nose, more than 5 degrees, at which slowest and fastest load are equal."""
    slow, fast = (runs.kinematic(speed) for speed in (SPEEDS[0], SPEEDS[-1]))
    angle, change = slow.angle_deg, fast.load - slow.load
    lifted = (angle > 91.0) & (angle < 269.0)
    at = np.flatnonzero((change[:-1] * change[1:] < 0.0) & lifted[:-1])
    found = angle[at] - change[at] * (angle[at + 1] - angle[at]) / (change[at + 1] - change[at]) - NOSE_DEG
    return {"angles": found[np.abs(found) > 5.0].tolist()}


def _find_oscillation(cycle: Cycle, rigid: Cycle) -> Vector:
    """What the flexible shaft changes of the load, less the mean of that over one period of its bending."""
    shaft = read_parameters(cycle.reference.system, "camshaft")
    period_deg = 2.0 * math.pi / compute_bending_rate(shaft) * cycle.run.speed_rpm * 6.0
    n = max(3, 2 * round(0.5 * period_deg / 360.0 * INTERVALS) + 1)
    change = (cycle.load - rigid.load)[:-1]
    padded = np.concatenate([change[-(n // 2) :], change, change[: n // 2]])
    return np.asarray(change - np.convolve(padded, np.full(n, 1.0 / n), mode="valid"))


@cache
def measure_seat_bounce(runs: Runs) -> Values:
    """How far a valve with a seat and 0.2 mm of lash leaves its seat again after landing (m)."""
    return {
        "slow": _bounce(1000.0, "0 mm"), "fast": _bounce(3000.0, "0 mm"), "ramped": _bounce(3000.0, "0.3 mm"),
        "on_paper_film": _bounce(3000.0, "0 mm", "kushwaha"), "dry": _bounce(3000.0, "0 mm", "dry"),
    }  # fmt: skip


def _bounce(speed_rpm: float, ramp: str, film: str = "dowson_toyoda") -> float:
    """Highest lift in the 60 degrees after the first landing, in the first turn, on a rigid shaft."""
    scenario = load(
        "valve-train",
        [
            "components.valve_spring.parameters.lash='0.2 mm'",
            "components.valve_spring.parameters.seat_stiffness=2e7",
            "components.valve_spring.parameters.seat_damping=300",
            f"components.flywheel.parameters.initial_speed='{speed_rpm} rpm'",
            f"components.camshaft.parameters.ramp_height='{ramp}'",
            f"components.contact.parameters.film_model='{film}'",
        ],
    )
    system = resolve_start(scenario, build_system(scenario))
    times = np.linspace(0.0, 60.0 / speed_rpm, INTERVALS + 1)
    lift = solve(system, times, tolerance=1e-8, x0=system.x0)["valve_spring.valve_lift"]
    highest = int(np.argmax(lift))
    landed = highest + int(np.argmax(lift[highest:] <= 0.0))
    return max(0.0, float(lift[landed : landed + INTERVALS // 6].max()))


@cache
def compare_shafts(runs: Runs) -> Values:
    """What a flexible camshaft changes at 600 r/min."""
    cycle, longer, rigid = runs.flexible(), runs.flexible(shaft_length_mm=200.0), runs.surge(FLEXIBLE_SPEED)
    change, swing, angle = cycle.load - rigid.load, np.abs(_find_oscillation(cycle, rigid)), cycle.angle_deg
    found = {n: swing[(angle[:-1] >= a) & (angle[:-1] <= b)].max() for n, (a, b) in SPANS.items()}
    twist = cycle.reference.state[:, cycle.reference.system.state.names.index("camshaft.twist")]
    lag, lead = int(np.argmin(twist)), int(np.argmax(twist))
    u, u0 = (c["camshaft.entraining_velocity"] for c in (cycle, rigid))
    speed = cycle["camshaft.cam_speed"]
    return {
        "away": np.abs(change).max(), "swing": swing.max(),
        "longer_away": np.abs(longer.load - rigid.load).max(),
        "longer_swing": np.abs(_find_oscillation(longer, rigid)).max(),
        "swings": list(found.values()), "each_swing": [f"{v:.2f} N over {n}°" for n, v in found.items()],
        "lag": math.degrees(twist[lag]), "lag_deg": angle[lag],
        "lead": math.degrees(twist[lead]), "lead_deg": angle[lead],
        "twist_stiffness": shaft_element(read_parameters(cycle.reference.system, "camshaft")).twist_stiffness,
        "lowest": change.min(), "highest": change.max(), "least_load": cycle.load.min(),
        "speed_share": np.abs(speed / np.mean(speed) - 1.0).max(),
        "velocity_share": np.abs(u - u0).max() / np.abs(u0).max(),
        "film_change": np.abs(cycle.film - rigid.film).max(),
    }  # fmt: skip
