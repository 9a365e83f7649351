"""Sections 2 and 4: parts, valve spring, Hertz's contact, constrained multibody equations."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
from scipy.integrate import quad

from models.contact.hertz import compliance_of, deflection, half_width, maximum_pressure
from models.valve_train.camshaft import shaft_element
from models.valve_train.valve_spring import lumping, spring_frequencies

from ...statement import rms
from ..runs import NOSE_DEG, Runs

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

Numbers = dict[str, Any]


def count_parts(runs: Runs) -> Numbers:
    """Parts, freedoms and equations."""
    each, removed = FIRST_ORDER + MOMENTA, sum(TABLE_2)
    return {
        "listed": LISTED_PARTS, "with_ground": LISTED_PARTS + 1, "moving": MOVING_PARTS, "removed": removed,
        "left": 6 * MOVING_PARTS - removed - 1, "constraints": WRITTEN_CONSTRAINTS,
        "first_order": FIRST_ORDER, "momenta": MOMENTA, "each": each, "of_five": 5 * each,
        "equations": MOVING_PARTS * each,
    }  # fmt: skip


def list_masses(runs: Runs) -> Numbers:
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


def compare_coil_masses(runs: Runs) -> Numbers:
    """Two coil masses beside eight, which hold the continuous spring's mass within 1.5 %."""
    two, eight, none = runs.surge(3000.0), runs.surge(3000.0, coil_masses=8), runs.kinematic(3000.0)
    difference, surge = rms(two.load - eight.load), rms(eight.load - none.load)
    return {
        "difference": difference, "surge": surge, "share": difference / surge,
        "least_of_two": two.load.min(), "least_of_eight": eight.load.min(),
        "held": 2.0 * lumping(2).mass / (8.0 * lumping(8).mass),
    }  # fmt: skip


def compute_spring(runs: Runs) -> Numbers:
    """Lumped mass, rates and frequencies of the valve spring, as printed in (1) and with the square of pi."""
    p, share = runs.parameters("valve_spring"), lumping(2)
    printed = float(2.0 / 3.0 * p.spring_rate / (math.pi * p.surge_frequency**2))
    first, second = (float(f) for f in spring_frequencies(p, 2))
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
    return load, radius, float(p.length), compliance_of(p)


@cache
def compute_hertz(runs: Runs) -> Numbers:
    """The contact at the nose by formulas, and by integrals: of (4) over (8) the one in y is closed."""
    load, radius, length, sigma = find_nose_contact(runs)
    b, p0 = half_width(load, radius, length, sigma), maximum_pressure(load, radius, length, sigma)

    def strip(x: float) -> float:
        return 2.0 * p0 * math.sqrt(1.0 - (x / b) ** 2) * math.asinh(0.5 * length / x)

    printed = 2.0 * radius / (4.0 * runs.parameters("contact").youngs_modulus_1)
    return {
        "load": load, "half_width": b, "width_to_pressure": b / p0,
        "printed": printed, "times_printed": b / p0 / printed,
        "printed_width": math.sqrt(2.0 / math.pi * sigma * load * 2.0 * radius / length),
        "carried": quad(lambda x: math.sqrt(1.0 - x * x), -1.0, 1.0)[0] * b * length * p0,
        "closed": deflection(load, radius, length, sigma),
        "integral": 2.0 * sigma / math.pi * quad(strip, 0.0, b, epsabs=0.0, epsrel=1e-10)[0],
    }  # fmt: skip


def measure_contact(runs: Runs) -> Numbers:
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


def compute_shaft(runs: Runs) -> Numbers:
    """Frequencies of the camshaft, and what (33) and "2 per cent" make of it as printed."""
    p = runs.parameters("camshaft")
    bending, torsion = compute_bending_rate(p), math.sqrt(shaft_element(p).twist_stiffness / p.polar_inertia)
    return {
        "bending_growth": 1.0 / bending, "torsion_growth": 1.0 / torsion,
        "bending_Hz": bending / (2 * math.pi), "torsion_Hz": torsion / (2 * math.pi),
        "literal_ratio": 0.5 * LITERAL_DAMPING * 2.0 * math.pi * LITERAL_FREQUENCY,
        "used_ratio": p.shaft_damping_ratio,
    }  # fmt: skip


def check_constraints(runs: Runs) -> Numbers:
    """Rank of (18), (19): sin(theta) sin(phi) = sin(theta) cos(phi) = 0, by (psi, theta, phi); lift (m) and
    residual of (27), dy2/dpsi y3, of a follower on the cam at 120 degrees; the factor ds/dpsi of (36)."""
    phi, cam = 0.7, runs.lift(120.0)  # any phi has the same rank
    return {
        "rank": int(np.linalg.matrix_rank([[0.0, math.sin(phi), 0.0], [0.0, math.cos(phi), 0.0]])),
        "lift": cam.s, "residual": cam.ds * cam.s, "factor": runs.lift(NOSE_DEG).ds,
        "load": runs.kinematic().at("contact.load", NOSE_DEG),
        "preload": runs.parameters("valve_spring").preload,
    }  # fmt: skip
