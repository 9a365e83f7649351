"""Sections 4.6 and 5, Figs 2 and 3: the cam and the entraining velocity."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from models.core.quantities import Vector

from ..runs import KINEMATIC_SPEED, NOSE_DEG, SPEEDS, Runs
from .parts import Numbers

STATED_REVERSALS = (-36.0, -12.0, 12.0, 36.0)
# Largest acceleration s'' B^2/S of other rises of the same angle and lift.
OTHER_RISES = {"constant acceleration": 4.0, "simple harmonic": math.pi**2 / 2.0, "3-4-5 polynomial": 5.7735}
OMEGA = KINEMATIC_SPEED * math.pi / 30.0


def _lifts(runs: Runs, angles: Vector) -> Vector:
    """Lift and its derivatives, a row for each."""
    return np.array([runs.lift(a) for a in angles]).T


@cache
def measure_lift(runs: Runs) -> Numbers:
    """The event and its nose, and how continuous the acceleration is."""
    angles, p = np.linspace(0.0, 360.0, 36001), runs.parameters("camshaft")
    s, _, dds = _lifts(runs, angles)
    coarse, moved = angles[::10], angles[::10][s[::10] > 0.0]
    return {
        "begin_deg": moved[0], "end_deg": moved[-1], "middle_deg": 0.5 * (moved[0] + moved[-1]),
        "greatest_deg": coarse[np.argmax(s[::10])],
        "dwell_deg": 2.0 * math.degrees(p.dwell_half_width),
        "flat_deg": np.mean(s > 0.99 * runs.lift(NOSE_DEG).s) * 360.0,
        "jump": np.max(np.abs(np.diff(dds))) / np.max(np.abs(dds)),
        "steepest": 2.0 * math.pi / p.rise_angle * math.radians(angles[1]),
    }  # fmt: skip


@cache
def measure_acceleration(runs: Runs) -> Numbers:
    """Of the rise: s'' B^2/S, its spike at the nose (m/s^2), its symmetry, and the inertial forces (N)."""
    p, valve = runs.parameters("camshaft"), runs.parameters("valve_spring")
    rise, half = np.linspace(90.0, 180.0, 9001), np.linspace(0.0, 180.0, 1801)
    dds = _lifts(runs, rise)[2]
    off = np.max(np.abs(_lifts(runs, NOSE_DEG - half)[2] - _lifts(runs, NOSE_DEG + half)[2]))
    bend = max(abs(runs.lift(a).dds) for a in np.linspace(90.0, 180.0, 901))
    forces = [valve.valve_mass * bend * (speed * math.pi / 30.0) ** 2 for speed in SPEEDS]
    return {
        "coefficient": dds.max() * p.rise_angle**2 / p.lift,
        "others": [f"{name} {value:.2f}" for name, value in OTHER_RISES.items()],
        "largest_other": max(OTHER_RISES.values()),
        "lowest": (OMEGA**2 * dds).min(), "lowest_deg": rise[np.argmin(OMEGA**2 * dds)],
        "at_nose": OMEGA**2 * runs.lift(NOSE_DEG).dds,
        "asymmetry": off / np.max(np.abs(_lifts(runs, half)[2])),
        "forces": forces, "preload": valve.preload, "shares": [force / valve.preload for force in forces],
    }  # fmt: skip


def find_reversals(runs: Runs) -> Numbers:
    """Where entrainment reverses, from the nose, and the largest film of (10) without squeeze there."""
    found, film = [angle - NOSE_DEG for angle in runs.reversals_deg], "contact.steady_film_thickness"
    return {
        "angles": found,
        "off_deg": max(abs(a - b) for a, b in zip(found, STATED_REVERSALS, strict=True)),
        "film": max(runs.kinematic().at(film, a) for a in runs.reversals_deg),
    }


def compute_entrainment(runs: Runs) -> Numbers:
    """At the nose, and by the printed formula at 120 degrees."""
    u, cam = runs.entraining(NOSE_DEG), runs.lift(120.0)
    return {
        "at_nose": u, "needed_rpm": 4.0 / u * KINEMATIC_SPEED, "needed_radius": 2.0 * 4.0 / OMEGA,
        "printed": 0.5 * (runs.parameters("camshaft").base_radius + cam.s + 2.0 * cam.dds),
        "omega": OMEGA, "at_120": runs.entraining(120.0),
    }  # fmt: skip
