"""Sections 2 and 4, Figs 2 and 3: parts, spring, Hertz's contact, multibody equations, cam, entrainment."""

import math
from functools import cache
from typing import Any

import numpy as np
from scipy.integrate import quad

from models.contact.hertz import deflection, half_width, maximum_pressure, pair_compliance
from models.core.quantities import Vector
from models.valve_train.shaft_element import shaft_element
from models.valve_train.valve_spring import lumping

from ..statement import Values, rms
from .runs import KINEMATIC_SPEED, NOSE_DEG, SPEEDS, Runs

# Table 1: ranges of mass (kg) and of Ixx, Iyy, Izz (kg mm^2).
Range = tuple[float, float]
TABLE_1: dict[str, tuple[Range, Range, Range, Range]] = {
    "camshaft portion": ((0.15, 0.20), (55, 70), (55, 70), (170, 200)),
    "cam": ((0.20, 0.30), (73, 90), (53, 85), (98, 135)),
    "valve/follower": ((0.20, 0.25), (198, 210), (30, 45), (198, 210)),
    "spring mass": ((0.005, 0.010), (0.0075, 0.015), (0.0075, 0.015), (0.0075, 0.015)),
}
# Table 2: degrees of freedom that the joints of camshaft, cam, follower and both spring masses remove.
TABLE_2 = (4, 2, 5, 5, 5)
LISTED_PARTS, MOVING_PARTS = 5, 4
# Equations per part (4.3): six pairs of first order and three momenta.
FIRST_ORDER, MOMENTA = 12, 3
# 4.1: (16)-(19), (20)-(24), (27) and (30), (32).
WRITTEN_CONSTRAINTS = 4 + 5 + 2 + 1
# "2 per cent" as a time (s): C = 0.02 K.
LITERAL_DAMPING, LITERAL_FREQUENCY = 0.02, 500.0

STATED_REVERSALS = (-36.0, -12.0, 12.0, 36.0)
# Largest acceleration s'' B^2/S of other rises of the same angle and lift.
OTHER_RISES = {"constant acceleration": 4.0, "simple harmonic": math.pi**2 / 2.0, "3-4-5 polynomial": 5.7735}
OMEGA = KINEMATIC_SPEED * math.pi / 30.0


def count_parts(runs: Runs) -> Values:
    """Parts, freedoms and equations."""
    each, removed = FIRST_ORDER + MOMENTA, sum(TABLE_2)
    return {
        "listed": LISTED_PARTS, "with_ground": LISTED_PARTS + 1, "moving": MOVING_PARTS, "removed": removed,
        "left": 6 * MOVING_PARTS - removed - 1, "constraints": WRITTEN_CONSTRAINTS,
        "first_order": FIRST_ORDER, "momenta": MOMENTA, "each": each, "of_five": 5 * each,
        "equations": MOVING_PARTS * each,
    }  # fmt: skip


def list_masses(runs: Runs) -> Values:
    """Masses of the model's parts, and moments of inertia: none exceeds the sum of the other two."""
    camshaft = runs.parameters("camshaft")
    impossible = [
        name
        for name, (_, *axes) in TABLE_1.items()
        if any(axes[i][0] > axes[i - 1][1] + axes[i - 2][1] for i in range(3))
    ]
    low, high = (sum(TABLE_1[name][0][i] for name in ("camshaft portion", "cam")) for i in (0, 1))
    return {
        "follower": runs.parameters("valve_spring").valve_mass,
        "camshaft": camshaft.mass, "camshaft_low": low, "camshaft_high": high,
        "impossible": impossible,
        "largest_sum": 2 * TABLE_1["camshaft portion"][1][1], "least": TABLE_1["camshaft portion"][3][0],
        "polar": 1e6 * camshaft.polar_inertia, "transverse": 1e6 * camshaft.transverse_inertia,
    }  # fmt: skip


def compare_coil_masses(runs: Runs) -> Values:
    """Two coil masses beside eight, which hold the continuous spring's mass within 1.5 %."""
    two, eight, none = runs.surge(3000.0), runs.surge(3000.0, coil_masses=8), runs.kinematic(3000.0)
    difference, surge = rms(two.load - eight.load), rms(eight.load - none.load)
    return {
        "difference": difference, "surge": surge, "share": difference / surge,
        "least_of_two": two.load.min(), "least_of_eight": eight.load.min(),
        "held": 2.0 * lumping(2).mass / (8.0 * lumping(8).mass),
    }  # fmt: skip


def compute_spring(runs: Runs) -> Values:
    """Lumped mass, rates and frequencies of the valve spring, as printed in (1) and with the square of pi."""
    p, share = runs.parameters("valve_spring"), lumping(2)
    printed = float(2.0 / 3.0 * p.spring_rate / (math.pi * p.surge_frequency**2))
    rates = share.end_rate, share.end_rate + 2.0 * share.inner_rate  # coils in phase, and against each other
    first, second = (0.5 * float(p.surge_frequency) * math.sqrt(rate / share.mass) for rate in rates)
    static = p.spring_rate / (2.0 / share.end_rate + 1.0 / share.inner_rate)
    return {
        "printed_kg": printed,
        "corrected_kg": share.mass * p.spring_rate / (math.pi * p.surge_frequency) ** 2,
        "stated_Hz": p.surge_frequency,
        "printed_Hz": math.sqrt(share.end_rate * p.spring_rate / printed) / (2.0 * math.pi),
        "first_Hz": first, "second_Hz": second, "ratio": second / first,
        "end_rate": share.end_rate, "inner_rate": share.inner_rate, "spring_rate": p.spring_rate,
        "static_kN": 1e-3 * static, "static_rate": static,
        # Clamped coils with the signs of (41) and (42) grow with these times (s).
        "growth": [1.0 / (2.0 * math.pi * f) for f in (first, second)],
    }  # fmt: skip


def find_nose_contact(runs: Runs) -> tuple[float, float, float, float]:
    """Load, radius, contact length and compliance at the nose."""
    cycle, p = runs.kinematic(), runs.parameters("contact")
    load, radius = (cycle.at(name, NOSE_DEG) for name in ("contact.load", "camshaft.radius_of_curvature"))
    return load, radius, float(p.length), pair_compliance(p)


@cache
def compute_hertz(runs: Runs) -> Values:
    """The contact at the nose by formulas, and by integrals: of (4) over (8) the one in y is closed."""
    load, radius, length, sigma = find_nose_contact(runs)
    b, p0 = half_width(load, radius, length, sigma), maximum_pressure(load, radius, length, sigma)

    def integrate_strip(x: float) -> float:
        return 2.0 * p0 * math.sqrt(1.0 - (x / b) ** 2) * math.asinh(0.5 * length / x)

    printed = 2.0 * radius / (4.0 * runs.parameters("contact").youngs_modulus_1)
    return {
        "load": load, "half_width": b, "width_to_pressure": b / p0,
        "printed": printed, "times_printed": b / p0 / printed,
        "printed_width": math.sqrt(2.0 / math.pi * sigma * load * 2.0 * radius / length),
        "carried": quad(lambda x: math.sqrt(1.0 - x * x), -1.0, 1.0)[0] * b * length * p0,
        "closed": deflection(load, radius, length, sigma),
        "integral": 2.0 * sigma / math.pi * quad(integrate_strip, 0.0, b, epsabs=0.0, epsrel=1e-10)[0],
    }  # fmt: skip


def measure_contact(runs: Runs) -> Values:
    """Width and pressure of the contact over the cycle."""
    cycle = runs.kinematic()
    width, pressure = cycle["contact.half_width"], cycle["contact.maximum_pressure"]
    return {
        "of_radius": (width / cycle["camshaft.radius_of_curvature"]).max(),
        "of_length": (width / runs.parameters("contact").length).max(),
        "lowest_MPa": pressure.min() / 1e6, "highest_MPa": pressure.max() / 1e6,
    }  # fmt: skip


def compute_bending_rate(p: Any) -> float:
    """First angular frequency of the camshaft in bending (rad/s)."""
    e = shaft_element(p)
    squares = np.linalg.eigvals(
        np.linalg.solve(np.diag([p.mass, p.transverse_inertia]), [[e.k11, e.k12], [e.k12, e.k22]])
    )
    return float(np.sqrt(np.min(np.real(squares))))


def compute_shaft(runs: Runs) -> Values:
    """Frequencies of the camshaft, and what (33) and "2 per cent" make of it as printed."""
    p = runs.parameters("camshaft")
    bending, torsion = compute_bending_rate(p), math.sqrt(shaft_element(p).twist_stiffness / p.polar_inertia)
    return {
        "bending_growth": 1.0 / bending, "torsion_growth": 1.0 / torsion,
        "bending_Hz": bending / (2 * math.pi), "torsion_Hz": torsion / (2 * math.pi),
        "literal_ratio": 0.5 * LITERAL_DAMPING * 2.0 * math.pi * LITERAL_FREQUENCY,
        "used_ratio": p.shaft_damping_ratio,
    }  # fmt: skip


def check_constraints(runs: Runs) -> Values:
    """Rank of (18), (19): sin(theta) sin(phi) = sin(theta) cos(phi) = 0, by (psi, theta, phi); lift (m) and
    residual of (27), dy2/dpsi y3, of a follower on the cam at 120 degrees; the factor ds/dpsi of (36)."""
    phi, cam = 0.7, runs.lift(120.0)  # any phi has the same rank
    return {
        "rank": int(np.linalg.matrix_rank([[0.0, math.sin(phi), 0.0], [0.0, math.cos(phi), 0.0]])),
        "lift": cam.s, "residual": cam.ds * cam.s, "factor": abs(runs.lift(NOSE_DEG).ds),
        "load": runs.kinematic().at("contact.load", NOSE_DEG),
        "preload": runs.parameters("valve_spring").preload,
    }  # fmt: skip


def _compute_lifts(runs: Runs, angles: Vector) -> Vector:
    """Lift and its derivatives, a row for each."""
    return np.array([runs.lift(a) for a in angles]).T


@cache
def measure_lift(runs: Runs) -> Values:
    """The event and its nose, and how continuous the acceleration is."""
    angles, p = np.linspace(0.0, 360.0, 36001), runs.parameters("camshaft")
    s, _, dds = _compute_lifts(runs, angles)
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
def measure_acceleration(runs: Runs) -> Values:
    """The rise's s'' B^2/S, its spike at the nose (m/s^2) and its symmetry; inertial forces (N)."""
    p, valve = runs.parameters("camshaft"), runs.parameters("valve_spring")
    rise, half = np.linspace(90.0, 180.0, 9001), np.linspace(0.0, 180.0, 1801)
    dds = _compute_lifts(runs, rise)[2]
    off = np.max(np.abs(_compute_lifts(runs, NOSE_DEG - half)[2] - _compute_lifts(runs, NOSE_DEG + half)[2]))
    bend = max(abs(runs.lift(a).dds) for a in np.linspace(90.0, 180.0, 901))
    forces = [valve.valve_mass * bend * (speed * math.pi / 30.0) ** 2 for speed in SPEEDS]
    return {
        "coefficient": dds.max() * p.rise_angle**2 / p.lift,
        "others": [f"{name} {value:.2f}" for name, value in OTHER_RISES.items()],
        "largest_other": max(OTHER_RISES.values()),
        "lowest": (OMEGA**2 * dds).min(), "lowest_deg": rise[np.argmin(OMEGA**2 * dds)],
        "at_nose": OMEGA**2 * runs.lift(NOSE_DEG).dds,
        "asymmetry": off / np.max(np.abs(_compute_lifts(runs, half)[2])),
        "forces": forces, "preload": valve.preload, "shares": [force / valve.preload for force in forces],
    }  # fmt: skip


def find_reversals(runs: Runs) -> Values:
    """Where entrainment reverses, from the nose, and the largest film of (10) without squeeze there."""
    found, film = [angle - NOSE_DEG for angle in runs.reversals_deg], "contact.steady_film_thickness"
    return {
        "angles": found,
        "off_deg": max(abs(a - b) for a, b in zip(found, STATED_REVERSALS, strict=True)),
        "film": max(runs.kinematic().at(film, a) for a in runs.reversals_deg),
    }


def compute_entrainment(runs: Runs) -> Values:
    """Entraining velocity at the nose, and by the printed formula at 120 degrees."""
    u, cam = runs.entraining(NOSE_DEG), runs.lift(120.0)
    return {
        "at_nose": u, "needed_rpm": 4.0 / u * KINEMATIC_SPEED, "needed_radius": 2.0 * 4.0 / OMEGA,
        "printed": 0.5 * (runs.parameters("camshaft").base_radius + cam.s + 2.0 * cam.dds),
        "omega": OMEGA, "at_120": runs.entraining(120.0),
    }  # fmt: skip
