"""Section 5, Figs 6 and 8: the contact load with spring surge and with a flexible camshaft."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from models.quantities import Vector
from models.valve_train.camshaft import shaft_element

from ...statement import Statement, Verdict, met_if, rms
from ..runs import FLEXIBLE_SPEED, INTERVALS, KINEMATIC_SPEED, NOSE_DEG, SPEEDS, Cycle, Runs, parameters
from .check import Check
from .equations import bending_rate

LENGTHS_MM = (100.0, 200.0)


def _per_speed(values: dict[float, float], form: str = "{:.1f}") -> str:
    return ", ".join(form.format(value) for value in values.values())


def inertia_negligible(runs: Runs) -> Statement:
    p = runs.parameters("valve_spring")
    forces = {}
    for speed in SPEEDS:
        omega = speed * math.pi / 30.0
        bend = max(abs(runs.lift(a).dds) for a in np.linspace(90.0, 180.0, 901))
        forces[speed] = p.valve_mass * bend * omega**2
    shares = {speed: force / p.preload for speed, force in forces.items()}
    return Statement(
        "inertia-negligible",
        "5",
        "Inertial effects can be neglected at low valve speeds",
        f"largest inertial force {_per_speed(forces, '{:.0f}')} N at 600, 1000, 2000, 3000 r/min beside a "
        "preload of "
        f"{p.preload:.0f} N",
        met_if(shares[SPEEDS[0]] < 0.1),
        f"{100 * shares[600.0]:.0f} % at 600, but already {100 * shares[KINEMATIC_SPEED]:.0f} % at 1000 "
        "r/min",
        {f"force_{speed:.0f}_rpm": force for speed, force in forces.items()},
    )


def larger_loads(runs: Runs) -> Statement:
    lows = {speed: float(runs.surge(speed).load.min()) for speed in SPEEDS}
    highs = {speed: float(runs.surge(speed).load.max()) for speed in SPEEDS}
    flank = {speed: float(runs.surge(speed).between("contact.load", 90.0, 134.0).max()) for speed in SPEEDS}
    values = list(flank.values())
    return Statement(
        "larger-loads",
        "5, Fig. 6",
        "Larger contact loads occur at higher speeds",
        f"largest {_per_speed(highs)} N, on the flank {_per_speed(flank)} N; least {_per_speed(lows)} N "
        "at 600, 1000, "
        "2000, 3000 r/min",
        met_if(all(a < b for a, b in pairwise(values))),
        "on the flanks; between the crossovers the loads fall with speed, and up to 2000 r/min the "
        "largest is the spring's, at the nose",
        {
            f"{kind}_{speed:.0f}_rpm": float(found[speed])
            for kind, found in (("least", lows), ("largest", highs))
            for speed in SPEEDS
        },
    )


def surge_grows(runs: Runs) -> Statement:
    sizes = {speed: rms(runs.surge(speed).load - runs.kinematic(speed).load) for speed in SPEEDS}
    values = list(sizes.values())
    return Statement(
        "surge-grows",
        "5, Fig. 6",
        "Surge becomes significant at progressively increasing speeds: perturbations at 3000 r/min",
        f"surge changes the load by {_per_speed(sizes, '{:.2f}')} N rms at 600, 1000, 2000, 3000 r/min",
        met_if(all(a < b for a, b in pairwise(values)) and values[-1] > 5.0),
        "",
        {f"rms_{speed:.0f}_rpm": value for speed, value in sizes.items()},
    )


def surge_at_low_loads(runs: Runs) -> Statement:
    cycle, plain = runs.surge(3000.0), runs.kinematic(3000.0).load
    change = cycle.load - plain
    low = plain < np.median(plain) * (1.0 + 1e-9)
    parts = rms(change[low]), rms(change[~low])
    shares = rms(change[low] / plain[low]), rms(change[~low] / plain[~low])
    return Statement(
        "surge-at-low-loads",
        "5, Fig. 6",
        "The surge's fluctuations appear particularly where contact forces are low",
        f"3000 r/min, {parts[0]:.1f} N rms where the load is low and {parts[1]:.1f} N where it is high: "
        f"{100 * shares[0]:.1f} % and {100 * shares[1]:.1f} % of the load",
        met_if(shares[0] > shares[1]),
        "relative to the load; in newtons they are everywhere of the same order",
        {"low_N": parts[0], "high_N": parts[1], "low_share": shares[0], "high_share": shares[1]},
    )


def load_unchanged(runs: Runs) -> Statement:
    """Where u = 0, s'' = -(R0 + s)/2: the inertial load there grows with the square of the speed."""
    loads = {a: [runs.surge(speed).at("contact.load", a) for speed in SPEEDS] for a in runs.reversals_deg}
    text = "; ".join(f"{a:.0f}°: " + ", ".join(f"{w:.0f}" for w in found) for a, found in loads.items())
    return Statement(
        "load-unchanged",
        "5, Fig. 6",
        "In the regions with no entraining motion the load is almost unchanged (crossover points)",
        f"N at 600, 1000, 2000, 3000 r/min: {text}",
        Verdict.CANNOT,
        "where u = 0, s″ = −(R0 + s)/2, a large deceleration: the load must fall with the square of the "
        "speed",
        {
            f"{a:.0f}_deg_{speed:.0f}_rpm": w
            for a, found in loads.items()
            for speed, w in zip(SPEEDS, found, strict=True)
        },
    )


def crossovers(runs: Runs) -> Statement:
    slow, fast = (runs.kinematic(speed) for speed in (SPEEDS[0], SPEEDS[-1]))
    change = fast.load - slow.load
    lifted = (slow.angle_deg > 91.0) & (slow.angle_deg < 269.0)
    signs = np.flatnonzero((change[:-1] * change[1:] < 0.0) & lifted[:-1])
    found = [
        float(
            slow.angle_deg[i]
            - change[i] * (slow.angle_deg[i + 1] - slow.angle_deg[i]) / (change[i + 1] - change[i])
        )
        for i in signs
    ]
    outer = [a - NOSE_DEG for a in found if abs(a - NOSE_DEG) > 5.0]
    return Statement(
        "crossovers",
        "5, Fig. 6",
        "The loads of different speeds have crossover points at the reversals, ±12° and ±36°",
        f"they cross at {', '.join(f'{a:+.2f}°' for a in outer)} and at the nose",
        Verdict.NOT_MET,
        "where s″ = 0; with surge, the curves pass near these points",
        {"first_deg": outer[0], "last_deg": outer[-1]},
    )


def no_separation(runs: Runs) -> Statement:
    rigid, flexible = (float(c.load.min()) for c in (runs.surge(3000.0), runs.flexible(3000.0)))
    preload = runs.parameters("valve_spring").preload
    return Statement(
        "no-separation",
        "1, 2.2, 5",
        "Jump: loss of contact through separation at high speed",
        f"least load at 3000 r/min {rigid:.1f} N, with the flexible camshaft {flexible:.1f} N",
        Verdict.CANNOT,
        f"the source's constraint cannot open (2.2), and it names no preload; with the {preload:.0f} N "
        "chosen here contact is kept",
        {"rigid_N": rigid, "flexible_N": flexible},
    )


def _oscillation(cycle: Cycle, rigid: Cycle) -> Vector:
    """What the flexible shaft changes of the load, less the mean of that over one period of its bending."""
    shaft = parameters(cycle.reference.system, "camshaft")
    period_deg = 2.0 * math.pi / bending_rate(shaft) * cycle.run.speed_rpm * 6.0
    n = max(3, 2 * round(0.5 * period_deg / 360.0 * INTERVALS) + 1)
    change = (cycle.load - rigid.load)[:-1]
    padded = np.concatenate([change[-(n // 2) :], change, change[: n // 2]])
    return np.asarray(change - np.convolve(padded, np.full(n, 1.0 / n), mode="valid"))


def sharp_oscillations(runs: Runs) -> Statement:
    rigid = runs.surge(FLEXIBLE_SPEED)
    parts, values = [], {}
    for length in LENGTHS_MM:
        cycle = runs.flexible(FLEXIBLE_SPEED, length)
        away = float(np.max(np.abs(cycle.load - rigid.load)))
        swing = float(np.max(np.abs(_oscillation(cycle, rigid))))
        parts.append(f"{away:.1f} N (oscillation ±{swing:.1f} N) with l = {length:.0f} mm")
        values |= {f"difference_{length:.0f}_mm": away, f"oscillation_{length:.0f}_mm": swing}
    return Statement(
        "sharp-oscillations",
        "5, Fig. 8",
        "Camshaft flexibility superimposes sharp oscillations on the steady load at 600 r/min",
        f"the load differs from that of a rigid camshaft by at most {', '.join(parts)}",
        Verdict.CANNOT,
        "with a realistic shaft nearly all of it is the static bending, and the oscillations are too "
        "small to be "
        "seen beside the load, even of a shaft twice as long",
        values,
    )


def oscillation_grows(runs: Runs) -> Statement:
    cycle, rigid = runs.flexible(), runs.surge(FLEXIBLE_SPEED)
    swing = np.abs(_oscillation(cycle, rigid))
    angle = cycle.angle_deg[:-1]
    spans = {
        "90-120": (93.0, 120.0),
        "150-177": (150.0, 177.0),
        "183-210": (183.0, 210.0),
        "240-267": (240.0, 267.0),
    }
    found = {name: float(swing[(angle >= a) & (angle <= b)].max()) for name, (a, b) in spans.items()}
    early, before, after, late = found.values()
    return Statement(
        "oscillation-grows",
        "5, Fig. 8",
        "The oscillation's amplitude increases before the nose (wind-up) and after it (wind-down)",
        "largest " + ", ".join(f"{value:.2f} N over {name}°" for name, value in found.items()),
        met_if(before > early and late > after),
        "each jerk step (90°, both ends of the dwell, 270°) starts an oscillation that then decays",
        {f"swing_{name}_deg": value for name, value in found.items()},
    )


def wind_up(runs: Runs) -> Statement:
    cycle = runs.flexible()
    twist = cycle.reference.state[:, cycle.reference.system.state.names.index("camshaft.twist")]
    lowest, highest = int(np.argmin(twist)), int(np.argmax(twist))
    angles = [float(cycle.angle_deg[i]) for i in (lowest, highest)]
    stiffness = shaft_element(parameters(cycle.reference.system, "camshaft")).twist_stiffness
    return Statement(
        "wind-up",
        "5",
        "Camshaft wind-up before and wind-down after the contact at the nose",
        f"twist {1e3 * math.degrees(twist[lowest]):.1f} millidegrees at {angles[0]:.0f}°, "
        f"{1e3 * math.degrees(twist[highest]):+.1f} at {angles[1]:.0f}° (600 r/min, {stiffness:.0f} N m/rad)",
        met_if(90.0 < angles[0] < NOSE_DEG < angles[1] < 270.0 and twist[lowest] < 0.0 < twist[highest]),
        "",
        {"lag_rad": float(twist[lowest]), "lead_rad": float(twist[highest])},
    )


def velocity_change(runs: Runs) -> Statement:
    cycle, rigid = runs.flexible(), runs.surge(FLEXIBLE_SPEED)
    u, u0 = (c["camshaft.entraining_velocity"] for c in (cycle, rigid))
    share = float(np.max(np.abs(u - u0)) / np.max(np.abs(u0)))
    film = float(np.max(np.abs(cycle.film - rigid.film)))
    speed = cycle["camshaft.cam_speed"]
    fictitious = float(np.max(np.abs(speed / np.mean(speed) - 1.0)))
    return Statement(
        "velocity-change",
        "5",
        "The shaft's fictitious angular velocity increases the entraining velocity considerably",
        f"cam speed varies by {100 * fictitious:.2f} %, u by {100 * share:.2f} % of its largest value, "
        "the film by "
        f"{1e6 * film:.4f} µm at most (600 r/min)",
        met_if(share > 0.05),
        "small with the stiffness of a 20 mm shaft",
        {"speed_share": fictitious, "velocity_share": share, "film_change": film},
    )


def bounce(runs: Runs) -> Statement:
    cycle, rigid = runs.flexible(), runs.surge(FLEXIBLE_SPEED)
    change = cycle.load - rigid.load
    return Statement(
        "bounce",
        "5, Fig. 8",
        "Reduced loads indicate jump, increased loads bounce",
        f"the flexible camshaft changes the load by {change.min():+.1f} to {change.max():+.1f} N at 600 "
        "r/min; least load "
        f"{cycle.load.min():.0f} N",
        met_if(bool(change.max() > 0.0) and bool(cycle.load.min() < 0.0)),
        "the load is only reduced, as the bent shaft compresses the spring less, and far from zero",
        {"lowest_N": float(change.min()), "highest_N": float(change.max())},
    )


START: tuple[Check, ...] = (inertia_negligible,)
SPEED: tuple[Check, ...] = (larger_loads, surge_grows, surge_at_low_loads)
CROSSING: tuple[Check, ...] = (load_unchanged, crossovers, no_separation)
FLEXIBLE: tuple[Check, ...] = (sharp_oscillations, oscillation_grows, wind_up, bounce, velocity_change)
