"""Sections 4.6 and 5, Figs 2 and 3: the cam and the entraining velocity."""

from __future__ import annotations

import math

import numpy as np

from ...statement import Statement, Verdict, met_if, near
from ..runs import KINEMATIC_SPEED, NOSE_DEG, Runs
from .check import Check

STATED_REVERSALS = (-36.0, -12.0, 12.0, 36.0)
# Largest acceleration s'' B^2/S of other rises of the same angle and lift.
OTHER_RISES = {"constant acceleration": 4.0, "simple harmonic": math.pi**2 / 2.0, "3-4-5 polynomial": 5.7735}


def _grid() -> np.ndarray:
    return np.linspace(0.0, 360.0, 36001)


def event(runs: Runs) -> Statement:
    moved = [a for a in _grid()[::10] if runs.lift(a).s > 0.0]
    largest = max(_grid()[::10], key=lambda a: runs.lift(a).s)
    low, high = min(moved), max(moved)
    middle = 0.5 * (low + high)
    return Statement(
        "event",
        "5, Fig. 4",
        "Flank and nose action from 90° to 270°, nose at 180°",
        f"lift from {low:.1f}° to {high:.1f}°, middle {middle:.1f}°, greatest lift reached at {largest:.1f}°",
        met_if(abs(low - 90.0) < 0.5 and abs(high - 270.0) < 0.5 and near(middle, NOSE_DEG, 1e-3)),
        "",
        {"begin_deg": float(low), "end_deg": float(high)},
    )


def broadened_nose(runs: Runs) -> Statement:
    dwell = 2.0 * math.degrees(runs.parameters("camshaft").dwell_half_width)
    top = runs.lift(NOSE_DEG).s
    flat = np.mean([runs.lift(a).s > 0.99 * top for a in _grid()]) * 360.0
    return Statement(
        "broadened-nose",
        "5, Fig. 2",
        "The cam has a rather broadened flat nose",
        f"a dwell of {dwell:.2f}°; more than 99 % of the lift over {flat:.1f}°",
        met_if(dwell > 0.0),
        "the dwell's width follows from the reversals: without it they could not all be where they are "
        "stated",
        {"dwell_deg": dwell, "within_1_percent_deg": float(flat)},
    )


def acceleration_continuous(runs: Runs) -> Statement:
    angles = _grid()
    dds = np.array([runs.lift(a).dds for a in angles])
    jump = float(np.max(np.abs(np.diff(dds))) / np.max(np.abs(dds)))
    steepest = 2.0 * math.pi / runs.parameters("camshaft").rise_angle * math.radians(angles[1])
    return Statement(
        "acceleration-continuous",
        "5",
        "The acceleration variation is continuous",
        f"largest change over 0.01°: {jump:.1e} of the largest acceleration, as its slope asks "
        f"({steepest:.1e})",
        met_if(jump < 1.01 * steepest),
        "its slope (the jerk) jumps at the ends of rise, dwell and fall",
        {"relative_jump": jump},
    )


def acceleration_symmetric(runs: Runs) -> Statement:
    half = np.linspace(0.0, 180.0, 1801)
    off = max(abs(runs.lift(NOSE_DEG - a).dds - runs.lift(NOSE_DEG + a).dds) for a in half)
    off /= max(abs(runs.lift(a).dds) for a in half)
    return Statement(
        "acceleration-symmetric",
        "5",
        "The follower acceleration is symmetrical about the cam half-cycle",
        f"largest relative difference {off:.0e}",
        met_if(off < 1e-9),
        "",
        {"relative_difference": off},
    )


def acceleration_spike(runs: Runs) -> Statement:
    omega2 = (KINEMATIC_SPEED * math.pi / 30.0) ** 2
    angles = np.linspace(90.0, 180.0, 9001)
    acceleration = np.array([omega2 * runs.lift(a).dds for a in angles])
    lowest = int(np.argmin(acceleration))
    nose = omega2 * runs.lift(NOSE_DEG).dds
    return Statement(
        "acceleration-spike",
        "5, Fig. 2",
        "The acceleration has a sharp spike at the contact with the nose",
        f"from {acceleration[lowest]:.0f} m/s² at {angles[lowest]:.1f}° to {nose:.0f} m/s² at the nose "
        "and back "
        "(1000 r/min)",
        met_if(nose > 0.9 * acceleration.min() and nose >= 0.0),
        "a peak between two decelerations, with corners at both ends of the dwell; no acceleration of "
        "its own",
        {"lowest": float(acceleration[lowest]), "at_nose": nose},
    )


def acceleration_higher(runs: Runs) -> Statement:
    p = runs.parameters("camshaft")
    own = max(runs.lift(a).dds for a in np.linspace(90.0, 180.0, 9001)) * p.rise_angle**2 / p.lift
    others = ", ".join(f"{name} {value:.2f}" for name, value in OTHER_RISES.items())
    return Statement(
        "acceleration-higher",
        "5",
        "For a given rise the acceleration is somewhat higher than of many other cams",
        f"largest s'' B²/S = {own:.3f}; {others}",
        met_if(own > max(OTHER_RISES.values())),
        "",
        {"coefficient": own},
    )


def reversals(runs: Runs) -> Statement:
    found = [angle - NOSE_DEG for angle in runs.reversals_deg]
    off = max(abs(a - b) for a, b in zip(found, STATED_REVERSALS, strict=True))
    return Statement(
        "reversals",
        "5, Figs. 3, 4",
        "Zero entraining velocity at ±12° and ±36° from the nose",
        ", ".join(f"{a:+.6f}°" for a in found),
        met_if(off < 1e-6),
        "exactly one family of cycloidal cams with dwell has this; lift and its angle were solved from it",
        {"count": len(found), "largest_error_deg": off},
    )


def no_steady_film(runs: Runs) -> Statement:
    steady = max(runs.kinematic().at("contact.steady_film_thickness", a) for a in runs.reversals_deg)
    return Statement(
        "no-steady-film",
        "1, 5",
        "Under pure entraining motion the film is zero at ±12° and ±36°",
        f"film of (10) without squeeze there: {1e6 * steady:.1e} µm at most",
        met_if(steady < 1e-9),
        "",
        {"steady_film": steady},
    )


def nose_velocity(runs: Runs) -> Statement:
    u = runs.entraining(NOSE_DEG)
    needed = 4.0 / u * KINEMATIC_SPEED
    return Statement(
        "nose-velocity",
        "5",
        "The speed of entraining motion at the nose is in excess of 4 m/s (1000 r/min)",
        f"{u:.3f} m/s; 4 m/s needs {needed:.0f} cam r/min",
        Verdict.CANNOT,
        "u = ½ω(R0 + S): 4 m/s at 1000 r/min would be a nose radius of "
        f"{1e3 * 2.0 * 4.0 / (KINEMATIC_SPEED * math.pi / 30.0):.0f} mm",
        {"nose_velocity": u, "needed_rpm": needed},
    )


def velocity_formula(runs: Runs) -> Statement:
    p = runs.parameters("camshaft")
    cam = runs.lift(120.0)
    printed = 0.5 * (p.base_radius + cam.s + 2.0 * cam.dds)
    return Statement(
        "velocity-formula",
        "5",
        "u = ½(R0 + s + 2 j), j = (1/ω²) d²s/dt²",
        f"at 120° {1e3 * printed:.2f} mm, a length; times ω = {KINEMATIC_SPEED * math.pi / 30:.1f} rad/s "
        f"{runs.entraining(120.0):.4f} m/s",
        Verdict.CANNOT,
        "ω is lost; and with a varying ω, j = (s̈ − s′ω̇)/ω²",
        {"printed_m": printed, "velocity": runs.entraining(120.0)},
    )


CHECKS: tuple[Check, ...] = (
    broadened_nose,
    acceleration_higher,
    acceleration_symmetric,
    acceleration_continuous,
    acceleration_spike,
    no_steady_film,
    event,
    reversals,
)
NOSE: tuple[Check, ...] = (nose_velocity,)
FORMULA: tuple[Check, ...] = (velocity_formula,)
