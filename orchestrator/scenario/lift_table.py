"""Lift tables: CSV files of cam angle and lift, smoothed to the points of a cam profile.

The first line names both columns with their units, `angle [deg], lift [mm]`. Comma, semicolon or tab
separate; with semicolon or tab a comma may be the decimal sign. Lines that begin with # are comments. Where
the table says nothing the cam is round: its ends must then be on the base circle.
"""

from __future__ import annotations

import functools
import math
import re
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from models.core.quantities import Vector
from models.valve_train.cams.law import LawParameters
from models.valve_train.cams.smoothing import SmoothedLift, smooth_lift
from models.valve_train.cams.table import TURN, TableParameters

from .units import UnitError, to_unit

# A gap is longer than this many times the usual spacing.
GAP = 3.0
# Lifts up to this part of the largest are on the base circle.
ROUND = 1e-3
EXAMPLE = "the first line names the columns with their units, e.g. angle [deg], lift [mm]"


class LiftTableError(ValueError):
    """A file that is no lift table."""


@dataclass(frozen=True)
class LiftTable:
    """Samples of a lift: ascending angles (rad) within a turn, lifts (m), and the step (m) that they have."""

    angle: Vector
    lift: Vector
    rounding: float

    def smooth(self) -> SmoothedLift:
        """The smoothing spline over the turn, with a round cam in the gap."""
        angle, lift = self._close()
        try:
            return smooth_lift(angle, lift, self.rounding)
        except ValueError as error:
            raise LiftTableError(str(error)) from None

    def _close(self) -> tuple[Vector, Vector]:
        """The samples with those of the base circle, if the table leaves it out."""
        spacing = float(np.median(np.diff(self.angle)))
        gap = self.angle[0] + TURN - self.angle[-1]
        if gap <= GAP * spacing:
            return self.angle, self.lift
        ends = max(abs(self.lift[0]), abs(self.lift[-1]))
        if ends > ROUND * self.lift.max():
            raise LiftTableError(
                f"the table ends at {math.degrees(self.angle[0]):g} and {math.degrees(self.angle[-1]):g} deg "
                f"with {1e3 * ends:g} mm of lift: continue it to the base circle, or over the whole turn"
            )
        count = round(gap / spacing)
        added = self.angle[-1] + gap / count * np.arange(1, count)
        return np.append(self.angle, added), np.append(self.lift, np.zeros(count - 1))


def read_lift_table(path: Path) -> LiftTable:
    """The samples of a file. LiftTableError that names the file, the line and the remedy."""
    try:
        text = path.read_text("utf-8-sig")
    except OSError as error:
        raise LiftTableError(f"{path}: cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise LiftTableError(f"{path}: is no text file; {EXAMPLE}") from None
    lines = [
        (n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip() and line.lstrip()[0] != "#"
    ]
    if not lines:
        raise LiftTableError(f"{path}: is empty; {EXAMPLE}")
    try:
        return _parse(lines)
    except LiftTableError as error:
        raise LiftTableError(f"{path}: {error}") from None


@functools.lru_cache(maxsize=16)
def smooth_file(path: Path, changed: int) -> SmoothedLift:
    """The smoothed table of a file that was changed at this time (ns)."""
    table = read_lift_table(path)
    try:
        return table.smooth()
    except LiftTableError as error:
        raise LiftTableError(f"{path}: {error}") from None


# Parameters of a law without its ramps, which a table replaces: a scenario that is extended may have them.
OF_LAWS = {field.name for field in fields(LawParameters)} - {field.name for field in fields(TableParameters)}


def insert_lift_table(table: dict[str, Any]) -> dict[str, Any]:
    """A component's table with the points of its `lift_table` among structure and parameters."""
    path = Path(table["lift_table"])
    changed = path.stat().st_mtime_ns if path.exists() else 0
    smoothed = smooth_file(path, changed)
    points, event = smoothed.points, dict(zip(("event_begin", "event_end"), smoothed.event, strict=True))
    rest = {key: value for key, value in table.items() if key != "lift_table"}
    kept = {name: value for name, value in table.get("parameters", {}).items() if name not in OF_LAWS}
    return rest | {
        "structure": {**table.get("structure", {}), "table_points": points.angle.size},
        "parameters": {**points.parameters(), **event, **kept},
    }


def _parse(lines: list[tuple[int, str]]) -> LiftTable:
    number, header = lines[0]
    separator = next((s for s in (";", "\t", ",") if s in header), None)
    if separator is None:
        raise LiftTableError(f"line {number}, {header.strip()!r}: has one column; {EXAMPLE}")
    names = header.split(separator)
    angle_unit, lift_unit = _read_unit(names, 0, "rad"), _read_unit(names, 1, "m")
    rows = [_read_row(n, line, separator) for n, line in lines[1:]]
    if len(rows) < 2:
        raise LiftTableError(f"has {len(rows)} rows of numbers; a lift table has one for each degree or so")
    angle = np.array([row[0] for row in rows]) * angle_unit
    lift = np.array([row[1] for row in rows]) * lift_unit
    if not lift.max() > 0.0:
        raise LiftTableError(f"its largest lift is {1e3 * lift.max():g} mm: must be > 0")
    _check_order(angle, lines)
    if angle[-1] < angle[0]:
        angle, lift = angle[::-1], lift[::-1]
    return LiftTable(*_cut_at_a_turn(angle, lift), rounding=_find_step([row[2] for row in rows]) * lift_unit)


def _read_unit(names: list[str], column: int, unit: str) -> float:
    """What the column's unit is in `unit`."""
    what = ("angle", "lift")[column]
    written = re.search(r"[\[(]\s*([^\])]+?)\s*[\])]", names[column])
    if written is None:
        raise LiftTableError(f"column {column + 1}, {names[column].strip()!r}: has no unit; {EXAMPLE}")
    try:
        return to_unit(f"1 {written[1]}", unit)
    except UnitError:
        raise LiftTableError(
            f"column {column + 1}, {names[column].strip()!r}: is no {what}; {EXAMPLE}"
        ) from None


def _read_row(number: int, line: str, separator: str) -> tuple[float, float, int]:
    """Angle, lift, and decimals of the lift."""
    cells = [cell.strip() for cell in line.split(separator)]
    if separator != ",":
        cells = [cell.replace(",", ".") for cell in cells]
    try:
        angle, lift = float(cells[0]), float(cells[1])
    except (ValueError, IndexError):
        raise LiftTableError(f"line {number}, {line.strip()!r}: must begin with two numbers") from None
    if not (math.isfinite(angle) and math.isfinite(lift)):
        raise LiftTableError(f"line {number}, {line.strip()!r}: must be finite numbers")
    mantissa, _, exponent = cells[1].lower().partition("e")
    return angle, lift, len(mantissa.partition(".")[2]) - int(exponent or 0)


def _check_order(angle: Vector, lines: list[tuple[int, str]]) -> None:
    wrong = np.flatnonzero(np.diff(angle) * (angle[-1] - angle[0]) <= 0.0)
    if wrong.size:
        number, line = lines[int(wrong[0]) + 2]
        raise LiftTableError(
            f"line {number}, {line.strip()!r}: the angles must ascend (or descend) without repetition"
        )
    turned = math.degrees(abs(angle[-1] - angle[0]))
    if turned > 360.0 * (1.0 + 1e-9):
        raise LiftTableError(
            f"spans {turned:g} deg: must be at most 360 deg of the cam (a crank turns twice as far)"
        )


def _cut_at_a_turn(angle: Vector, lift: Vector) -> tuple[Vector, Vector]:
    """Without the last sample where it repeats the first one a turn later."""
    repeated = angle[-1] - angle[0] > TURN * (1.0 - 1e-9)
    return (angle[:-1], lift[:-1]) if repeated else (angle, lift)


def _find_step(decimals: list[int]) -> float:
    """The step of numbers with so many decimals: that of the most precise one."""
    return float(10.0 ** -max(decimals))
