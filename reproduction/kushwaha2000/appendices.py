"""Appendices 1 to 3: the Euler transformation, a part's inertia and the constraints' gradients, line by line.

Gradients are taken of the constraints as K prints them, by complex steps, exact to rounding. Inertias come
from K's rotation alone: omega = L (psi', theta', phi'), K = omega I omega/2.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..statement import Values
from .parts import TABLE_1
from .runs import NOSE_DEG, Runs

Angles = tuple[Any, Any, Any]
Gradients = dict[str, dict[str, float]]

# Where the lines are compared: none of the terms vanishes there.
SAMPLES: tuple[Angles, ...] = ((0.4, 0.9, -0.7), (-2.0, 1.3, 0.2), (1.1, 0.5, 2.5))
# Any numbers do for l (m) and L_v (m).
SHAFT_LENGTH, VALVE_LENGTH = 0.1, 0.07
STEP = 1e-30
# Entries that differ by less are equal.
SAME = 1e-12
# Tilt (rad) at which what Appendix 2 leaves out is measured.
TILT = 0.01


def turn(axis: int, angle: Any) -> Any:
    """The rotation about x (0), y (1) or z (2)."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    rotation = np.eye(3, dtype=np.result_type(angle, float))
    rotation[i, i], rotation[i, j], rotation[j, i], rotation[j, j] = c, -s, s, c
    return rotation


def rotate(psi: Any, theta: Any, phi: Any) -> Any:
    """R_z(psi) R_x(theta) R_z(phi): Euler angles 3-1-3."""
    return turn(2, psi) @ turn(0, theta) @ turn(2, phi)


def print_rotation(psi: Any, theta: Any, phi: Any) -> Any:
    """The rotation of Appendix 1, in its rows."""
    c, s = np.cos, np.sin
    return np.array(
        [
            [
                c(psi) * c(phi) - s(psi) * c(theta) * s(phi),
                -c(psi) * s(phi) - s(psi) * c(theta) * c(phi),
                s(psi) * s(theta),
            ],
            [
                s(psi) * c(phi) + c(psi) * c(theta) * s(phi),
                -s(psi) * s(phi) + c(psi) * c(theta) * c(phi),
                -c(psi) * s(theta),
            ],
            [s(theta) * s(phi), s(theta) * c(phi), c(theta)],
        ]
    )


def check_rotation(runs: Runs) -> Values:
    """Largest difference of Appendix 1 from the product of three rotations."""
    apart = [np.max(np.abs(print_rotation(*angles) - rotate(*angles))) for angles in SAMPLES]
    return {"difference": max(apart), "elements": 9}


def find_inertia(own: Any, psi: Any, theta: Any, phi: Any) -> Any:
    """L^T R I R^T L, of which half the quadratic form in (psi', theta', phi') is the kinetic energy."""
    r = rotate(psi, theta, phi)
    lever = np.stack([np.array([0.0, 0.0, 1.0]), turn(2, psi)[:, 0], r[:, 2]], axis=1)
    return lever.T @ r @ np.diag(own) @ r.T @ lever


def print_inertia(own: Any, psi: Any, theta: Any, phi: Any) -> Any:
    """Rows a, b, c of Appendix 2."""
    ixx, iyy, izz = own
    s, c, sp, cp = np.sin(theta), np.cos(theta), np.sin(phi), np.cos(phi)
    a1 = ixx * s * s * sp * sp + iyy * s * s * cp * cp + izz * c * c
    a2, b2 = (ixx - iyy) * s * sp * cp, ixx * cp * cp + iyy * sp * sp
    return np.array([[a1, a2, izz * c], [a2, b2, 0.0], [izz * c * c, 0.0, izz * c]])


def list_cam_inertia() -> list[float]:
    """The cam's, from the middle of Table 1 (kg m^2)."""
    return [0.5e-6 * (low + high) for low, high in TABLE_1["cam"][1:]]


def check_inertia(runs: Runs) -> Values:
    """Terms of Appendix 2 that differ from the kinetic energy's, over the sample angles."""
    own = list_cam_inertia()
    apart = np.max([np.abs(print_inertia(own, *a) - find_inertia(own, *a)) for a in SAMPLES], axis=0)
    names = np.array([[f"{row}{column + 1}" for column in range(3)] for row in "abc"])
    wrong = [str(name) for name in names[apart > SAME * max(own)]]
    return {"terms": names.size, "wrong": wrong, "right": names.size - len(wrong)}


def check_momenta(runs: Runs) -> Values:
    """dK/dtheta (N m) of a cam that turns at 1000 r/min, tilted a little: M' = T leaves it out."""
    own, speed = list_cam_inertia(), 1000.0 * math.pi / 30.0
    rates = np.array([speed, 0.0, 0.0])
    energy = 0.5 * rates @ find_inertia(own, 0.3, TILT + 1j * STEP, 0.7) @ rates
    return {"left_out": float(energy.imag / STEP), "tilt": TILT}


def constrain(
    q: Mapping[str, Any], lift: Callable[[Any], Any], slope: Callable[[Any], Any]
) -> dict[str, Any]:
    """C1 to C12 as printed in (16) to (32), at t = 0."""
    shaft = print_rotation(q["psi1"], q["theta1"], q["phi1"])
    valve = print_rotation(q["psi3"], q["theta3"], q["phi3"])
    return {
        "C1": q["x1"] - SHAFT_LENGTH * shaft[0, 0],
        "C2": q["y1"] - SHAFT_LENGTH * shaft[1, 1],
        "C3": shaft[2, 0],
        "C4": shaft[2, 1],
        "C5": q["x3"] - VALVE_LENGTH * valve[0, 0],
        "C6": q["z3"] - VALVE_LENGTH * valve[2, 2],
        "C7": valve[1, 0],
        "C8": valve[1, 2],
        "C9": valve[0, 2],
        "C10": slope(q["psi2"]) * q["y3"],
        "C11": q["x3"] * lift(q["psi2"]),
        "C12": q["psi1"],
    }


def make_rise(runs: Runs) -> tuple[Callable[[Any], Any], Callable[[Any], Any]]:
    """(31) and its derivative."""
    p = runs.parameters("camshaft")
    lift, event = float(p.lift), float(p.rise_angle)

    def rise(psi: Any) -> Any:
        return lift * (psi / event - np.sin(2.0 * math.pi * psi / event) / (2.0 * math.pi))

    def slope(psi: Any) -> Any:
        return lift / event * (1.0 - np.cos(2.0 * math.pi * psi / event))

    return rise, slope


def place_parts(shaft: Angles, valve: Angles) -> dict[str, float]:
    names = ("x1", "y1", "psi2", "x3", "y3", "z3")
    q = dict(zip(names, (0.01, 0.02, 0.6, 0.005, 0.006, 0.03), strict=True))
    q |= dict(zip(("psi1", "theta1", "phi1"), shaft, strict=True))
    return q | dict(zip(("psi3", "theta3", "phi3"), valve, strict=True))


def differentiate(runs: Runs, q: Mapping[str, float]) -> Gradients:
    """dC/dq of the printed constraints; entries that vanish are left out."""
    rise, slope = make_rise(runs)
    found: Gradients = {}
    for name in q:
        moved = {**q, name: q[name] + 1j * STEP}
        for constraint, value in constrain(moved, rise, slope).items():
            if rate := float(np.imag(value) / STEP):
                found.setdefault(constraint, {})[name] = rate
    return found


def print_gradients(runs: Runs, q: Mapping[str, float]) -> Gradients:
    """The columns of Appendix 3. Its L_c is l of (16); the valve's angles have the subscript 2 there."""
    rise, slope = make_rise(runs)
    a, b, c = q["psi1"], q["theta1"], q["phi1"]
    d, e, f = q["psi3"], q["theta3"], q["phi3"]
    C, S, length, valve = math.cos, math.sin, SHAFT_LENGTH, VALVE_LENGTH
    return {
        "C1": {
            "x1": 1.0, "theta1": -length * S(a) * S(b) * S(c),
            "phi1": length * (S(a) * C(b) * C(c) + C(a) * S(c)),
        },
        "C2": {
            "y1": 1.0, "theta1": length * C(a) * S(b) * C(c),
            "phi1": length * (C(a) * C(b) * S(c) + S(a) * C(c)),
        },
        "C3": {"theta1": C(b) * S(c), "phi1": S(b) * C(c)},
        "C4": {"theta1": C(b) * C(c), "phi1": S(b) * S(c)},
        "C11": {"x3": float(rise(q["psi2"]))},
        "C10": {"y3": float(slope(q["psi2"]))},
        "C5": {
            "x3": 1.0, "psi3": valve * (C(d) * C(e) * S(f) + S(d) * C(f)),
            "theta3": -valve * S(d) * S(e) * S(f), "phi3": valve * (S(d) * C(e) * C(f) + C(d) * S(f)),
        },
        "C6": {"z3": 1.0, "theta3": valve * S(e)},
        "C7": {
            "psi3": C(d) * C(f) - S(d) * C(e) * S(f), "theta3": -C(d) * S(e) * S(f),
            "phi3": C(d) * C(e) * C(f) - S(d) * S(f),
        },
        "C8": {"psi3": S(d) * S(e), "theta3": -C(d) * C(e)},
        "C9": {"psi3": C(d) * S(e), "theta3": S(d) * C(e)},
    }  # fmt: skip


SYMBOLS = {"psi": "ψ", "theta": "θ", "phi": "φ"}


def name_entry(constraint: str, coordinate: str) -> str:
    """∂C4/∂φ1."""
    letter = coordinate[:-1]
    return f"∂{constraint}/∂{SYMBOLS.get(letter, letter)}{coordinate[-1]}"


def check_gradients(runs: Runs) -> Values:
    """Entries of Appendix 3 that are right, wrong, or missing."""
    wrong: dict[str, None] = {}
    missing: dict[str, None] = {}
    count = 0
    for shaft, valve in zip(SAMPLES, SAMPLES[::-1], strict=True):
        q = place_parts(shaft, valve)
        printed, found = print_gradients(runs, q), differentiate(runs, q)
        entries = [(k, name) for k, column in printed.items() for name in column]
        count = len(entries)
        for k, name in entries:
            if abs(printed[k][name] - found[k].get(name, 0.0)) > SAME:
                wrong[name_entry(k, name)] = None
        for k, column in found.items():
            for name in column.keys() - printed.get(k, {}).keys():
                missing[name_entry(k, name)] = None
    return {
        "printed": count, "right": count - len(wrong), "wrong": list(wrong), "missing": sorted(missing),
        "missed": len(missing),
    }  # fmt: skip


def find_ranks(runs: Runs) -> Values:
    """Rank of the gradients of bearing (C1-C4) and guide (C5-C9) where both parts stand straight."""
    q = place_parts((0.3, 0.0, 0.2), (0.3, 0.0, -0.3))
    found, names = differentiate(runs, q), list(q)

    def rank(constraints: list[str]) -> int:
        rows = [[found.get(k, {}).get(name, 0.0) for name in names] for k in constraints]
        return int(np.linalg.matrix_rank(rows, tol=1e-9))

    return {"bearing": rank(["C1", "C2", "C3", "C4"]), "guide": rank(["C5", "C6", "C7", "C8", "C9"])}


def swing_axis(runs: Runs) -> Values:
    """Travel (m) of the shaft's centre by (16) and (17) in a turn about its axis."""
    angles = np.linspace(0.0, 2.0 * math.pi, 361)
    x = [SHAFT_LENGTH * print_rotation(a, 0.0, 0.0)[0, 0] for a in angles]
    return {"travel": float(max(x) - min(x)), "length": SHAFT_LENGTH}


def find_cam_torque(runs: Runs) -> Values:
    """W s' beside the load, at 135 degrees of the kinematic cycle."""
    cycle, angle = runs.kinematic(), NOSE_DEG - 45.0
    load, offset = cycle.at("contact.load", angle), cycle.at("camshaft.contact_offset", angle)
    return {"torque": load * offset, "load": load, **check_gradients(runs)}
