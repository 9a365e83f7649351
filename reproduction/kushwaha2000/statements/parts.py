"""Sections 2.1 to 2.3 and Tables 1 and 2: parts, constraints, valve spring."""

from __future__ import annotations

import math
from typing import Any

from models.valve_train.valve_spring import lumping, spring_frequencies

from ...statement import Statement, Verdict, met_if, near, rms
from ..runs import NOSE_DEG, Runs
from .check import Check

# Table 1: ranges of mass (kg) and of Ixx, Iyy, Izz (kg mm^2).
Range = tuple[float, float]
TABLE_1: dict[str, tuple[Range, Range, Range, Range]] = {
    "camshaft portion": ((0.15, 0.20), (55, 70), (55, 70), (170, 200)),
    "cam": ((0.20, 0.30), (73, 90), (53, 85), (98, 135)),
    "valve/follower": ((0.20, 0.25), (198, 210), (30, 45), (198, 210)),
    "spring mass": ((0.005, 0.010), (0.0075, 0.015), (0.0075, 0.015), (0.0075, 0.015)),
}
# Table 2: degrees of freedom that each joint removes.
TABLE_2 = {"camshaft": 4, "cam on follower": 2, "follower": 5, "spring mass 5": 5, "spring mass 6": 5}
LISTED_PARTS = 5


def table_1_inertias(runs: Runs) -> Statement:
    """Moments of inertia of a body: none exceeds the sum of the other two."""
    p = runs.parameters("camshaft")
    impossible = []
    for name, (_, xx, yy, zz) in TABLE_1.items():
        for one, others in ((xx, (yy, zz)), (yy, (xx, zz)), (zz, (xx, yy))):
            if one[0] > others[0][1] + others[1][1]:
                impossible.append(name)
    low, largest = TABLE_1["camshaft portion"][3][0], 2 * TABLE_1["camshaft portion"][1][1]
    return Statement(
        "table-1-inertias",
        "2.1, Table 1",
        "The parts' moments of inertia lie in the ranges of the table",
        f"no body has those of: {', '.join(impossible)} (Ixx + Iyy at most {largest:g}, Izz at least "
        f"{low:g} kg mm²)",
        Verdict.CANNOT if impossible else Verdict.MET,
        f"a body has Ixx + Iyy ≥ Izz; the model's camshaft with cam, {1e6 * p.polar_inertia:.0f} polar and "
        f"{1e6 * p.transverse_inertia:.0f} transverse, is from the same table and inherits the fault",
        {"impossible_parts": len(impossible), "Ixx_plus_Iyy_max": largest, "Izz_min": low},
    )


def follower_mass(runs: Runs) -> Statement:
    mass, (low, high) = runs.parameters("valve_spring").valve_mass, TABLE_1["valve/follower"][0]
    return Statement(
        "follower-mass",
        "Table 1",
        f"Valve/follower mass {low:.2f}-{high:.2f} kg",
        f"{mass:.3f} kg used",
        met_if(low <= mass <= high),
        "",
        {"mass_kg": mass},
    )


def camshaft_mass(runs: Runs) -> Statement:
    mass = runs.parameters("camshaft").mass
    low, high = (sum(TABLE_1[name][0][i] for name in ("camshaft portion", "cam")) for i in (0, 1))
    return Statement(
        "camshaft-mass",
        "Table 1",
        f"Camshaft portion and cam together {low:.2f}-{high:.2f} kg",
        f"{mass:.3f} kg used",
        met_if(low <= mass <= high),
        "",
        {"mass_kg": mass},
    )


def five_parts(runs: Runs) -> Statement:
    return Statement(
        "five-parts",
        "2.1, 4",
        "There are five parts in the model, including the ground",
        f"Table 1 lists {LISTED_PARTS} (two of them spring masses) without the ground: {LISTED_PARTS + 1}",
        Verdict.NOT_MET,
        "five including the ground only if camshaft and cam are one part",
        {"parts_with_ground": LISTED_PARTS + 1},
    )


def table_2_sum(runs: Runs) -> Statement:
    removed = sum(TABLE_2.values())
    moving = LISTED_PARTS - 1
    left = 6 * moving - removed - 1
    return Statement(
        "table-2-sum",
        "Table 2, 4.3",
        "The joints remove 4 + 2 + 5 + 5 + 5 degrees of freedom; λ_k, k = 1-21",
        f"sum {removed}; {moving} moving parts with 6 each, less these and the drive (32): {left} left",
        met_if(removed == 21),
        "the multipliers leave out that of the drive, the 22nd; of the three real freedoms (two spring "
        "masses, "
        "axial play of the cylindrical joint) one is counted away by the second curve-curve equation",
        {"removed": removed, "left": left},
    )


def two_masses_enough(runs: Runs) -> Statement:
    two, eight, none = runs.surge(3000.0), runs.surge(3000.0, coil_masses=8), runs.kinematic(3000.0)
    difference, surge = rms(two.load - eight.load), rms(eight.load - none.load)
    share = difference / surge
    # Converged: the mass of the continuous spring is reached within 1.5 % by eight.
    held = 2.0 * lumping(2).mass / (8.0 * lumping(8).mass)
    return Statement(
        "two-masses",
        "2.1",
        "Two point masses are enough to examine the spring surge effect",
        f"3000 r/min: two masses differ from eight by {difference:.1f} N rms, the whole effect of surge is "
        f"{surge:.1f} N rms; smallest load {two.load.min():.1f} N with two, {eight.load.min():.1f} N with "
        "eight",
        met_if(share < 0.1),
        f"the course of the surge is there, but {100 * share:.0f} % rms are missing (limit taken: 10 %): "
        "with the "
        f"first two frequencies right, the two masses hold only {100 * held:.0f} % of the spring's",
        {"rms_difference_N": difference, "rms_surge_N": surge, "mass_share": held},
    )


def _printed_mass(p: Any) -> float:
    """K (1) as printed."""
    return float(2.0 / 3.0 * p.spring_rate / (math.pi * p.surge_frequency**2))


def lumped_mass(runs: Runs) -> Statement:
    p = runs.parameters("valve_spring")
    low, high = TABLE_1["spring mass"][0]
    corrected = lumping(2).mass * p.spring_rate / (math.pi * p.surge_frequency) ** 2
    return Statement(
        "lumped-mass",
        "(1), Table 1",
        f"m5 = m6 = (2/3) k0/(π f0²); Table 1: {low:.3f}-{high:.3f} kg",
        f"{_printed_mass(p):.5f} kg as printed, {corrected:.5f} kg with π²",
        met_if(low <= _printed_mass(p) <= high),
        "the square of π is lost; with it the mass is inside Table 1",
        {"printed_kg": _printed_mass(p), "corrected_kg": corrected},
    )


def first_frequency(runs: Runs) -> Statement:
    p = runs.parameters("valve_spring")
    share = lumping(2)
    corrected = float(spring_frequencies(p, 2)[0])
    printed = math.sqrt(share.end_rate * p.spring_rate / _printed_mass(p)) / (2.0 * math.pi)
    return Statement(
        "first-frequency",
        "2.3, (1)",
        f"The lumped spring responds at f0 = {p.surge_frequency:g} Hz",
        f"{printed:.1f} Hz with (1) as printed, {corrected:.1f} Hz with π²",
        met_if(near(printed, p.surge_frequency)),
        "met with the corrected mass",
        {"printed_Hz": printed, "corrected_Hz": corrected},
    )


def static_rate(runs: Runs) -> Statement:
    p, share = runs.parameters("valve_spring"), lumping(2)
    rate = p.spring_rate / (2.0 / share.end_rate + 1.0 / share.inner_rate)
    return Statement(
        "static-rate",
        "(2), (3)",
        "k2 = 4 k0, k1 = k3 = (8/3) k0 give the static deflection of the spring",
        f"k1/k0 = {share.end_rate:.6f}, k2/k0 = {share.inner_rate:.6f}, in series {rate / 1e3:.6f} kN/m",
        met_if(near(rate, p.spring_rate, 1e-9) and near(share.inner_rate, 4.0, 1e-6)),
        "",
        {"end_rate": share.end_rate, "inner_rate": share.inner_rate, "static_rate": rate},
    )


def second_frequency(runs: Runs) -> Statement:
    first, second = spring_frequencies(runs.parameters("valve_spring"), 2)
    return Statement(
        "second-frequency",
        "2.3",
        "The second natural frequency is twice the fundamental",
        f"{second:.1f} Hz / {first:.1f} Hz = {second / first:.6f}",
        met_if(near(second / first, 2.0, 1e-6)),
        "",
        {"ratio": float(second / first)},
    )


def surge_signs(runs: Runs) -> Statement:
    """Eigenvalues of the clamped coils with the signs of (41), (42)."""
    rate = 2.0 * math.pi * spring_frequencies(runs.parameters("valve_spring"), 2)
    return Statement(
        "surge-signs",
        "(40)-(42)",
        "Equations of motion of follower and coil masses",
        f"as printed the coils grow by e in {1e3 / rate[0]:.3f} ms and {1e3 / rate[1]:.3f} ms",
        Verdict.CANNOT,
        "the signs of all spring and damping terms are reversed; corrected, they oscillate",
        {"growth_rate_1": float(rate[0]), "growth_rate_2": float(rate[1])},
    )


def load_factor(runs: Runs) -> Statement:
    """K (36) makes the load proportional to ds/dpsi."""
    factor, load = runs.lift(NOSE_DEG).ds, runs.kinematic().at("contact.load", NOSE_DEG)
    return Statement(
        "load-factor",
        "(36)",
        "W = (s/β)[1 − cos(2πψ/β)] λ6 is the contact load",
        f"the factor is {factor:.3g} at the nose and on the base circle, where the spring alone asks for "
        f"{load:.0f} N and {runs.parameters('valve_spring').preload:.0f} N",
        Verdict.CANNOT,
        "the factor ds/dψ belongs to the camshaft's torque; the load is the multiplier itself",
        {"factor_at_nose": factor, "load_at_nose_N": load},
    )


BEFORE: tuple[Check, ...] = (
    five_parts,
    table_1_inertias,
    follower_mass,
    camshaft_mass,
    two_masses_enough,
    table_2_sum,
    lumped_mass,
    static_rate,
    first_frequency,
    second_frequency,
)
EQUATIONS: tuple[Check, ...] = (load_factor, surge_signs)
