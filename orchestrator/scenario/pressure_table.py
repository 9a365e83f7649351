"""Pressure tables: files of crank angle and absolute pressure (`angle_table`) of a cycle, one turn or two.

Between the points goes the monotone cubic of Fritsch and Carlson (1980), which stays between the pressures of
its ends: a spline would swing beyond them at ignition, or where a trace is coarse.
"""

import math
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from models.core.quantities import Vector
from models.slider_crank.piston.cylinder_gas import CylinderGasParameters, CylinderParameters

from .angle_table import AngleTableError, Kind, read_angle_table

PRESSURE = Kind("pressure", "Pa", 2, "the crank", "angle [deg], pressure [bar]")
TURN = 2.0 * math.pi
# Parameters of the formula, which a table replaces: a scenario that is extended may have them.
OF_FORMULA = {f.name for f in fields(CylinderGasParameters)} - {f.name for f in fields(CylinderParameters)}
# A gap at the end is longer than this many times the usual spacing; ends of a cycle agree to this share.
GAP, AGREED = 3.0, 0.05
# Points on both sides from which the slope at an end follows.
BESIDE = 3


def insert_pressure_table(table: dict[str, Any]) -> dict[str, Any]:
    """A component's table with the points of its `pressure_table`, and `notes` of reading it."""
    path = Path(table["pressure_table"])
    found = read_angle_table(path, PRESSURE)
    try:
        turns, angle, pressure = _close_cycle(found.angle, found.value)
    except AngleTableError as error:
        raise AngleTableError(f"{path}: {error}") from None
    columns = {
        "pressure_angle": angle,
        "point_pressure": pressure,
        "pressure_slope": _find_slopes(angle, pressure, turns * TURN),
    }
    points = {f"{name}[{i}]": float(v) for name, column in columns.items() for i, v in enumerate(column, 1)}
    kept = {name: value for name, value in table.get("parameters", {}).items() if name not in OF_FORMULA}
    rest = {key: value for key, value in table.items() if key != "pressure_table"}
    return rest | {
        "notes": found.notes,
        "structure": {**table.get("structure", {}), "pressure_points": angle.size},
        "parameters": {"cycle_turns": float(turns), **points, **kept},
    }


def _close_cycle(angle: Vector, pressure: Vector) -> tuple[int, Vector, Vector]:
    """Turns of the cycle, and the points without the last one where it is the first a cycle later."""
    if not pressure.min() > 0.0:
        raise AngleTableError(
            f"its least pressure is {pressure.min():g} Pa: must be > 0; the table has absolute pressures, so "
            "add that of the surroundings to pressures above it"
        )
    turns = 1 if angle[-1] - angle[0] <= TURN * (1.0 + 1e-9) else 2
    spacing = float(np.median(np.diff(angle)))
    gap = angle[0] + turns * TURN - angle[-1]
    if gap > GAP * spacing:
        raise AngleTableError(
            f"spans {math.degrees(angle[-1] - angle[0]):g} deg: must go round the cycle, 360 or 720 deg of "
            "the crank"
        )
    if gap > 0.5 * spacing:
        return turns, angle, pressure
    if abs(pressure[-1] - pressure[0]) > AGREED * pressure.max():
        raise AngleTableError(
            f"begins with {pressure[0]:g} Pa and ends, a cycle later, with {pressure[-1]:g} Pa: must agree"
        )
    return turns, angle[:-1], pressure[:-1]


def _find_slopes(angle: Vector, pressure: Vector, period: float) -> Vector:
    """dp/dtheta (Pa) at the points, which go on periodically."""
    angles = np.r_[angle[-BESIDE:] - period, angle, angle[:BESIDE] + period]
    pressures = np.r_[pressure[-BESIDE:], pressure, pressure[:BESIDE]]
    return np.asarray(scipy.interpolate.PchipInterpolator(angles, pressures).derivative()(angle))
