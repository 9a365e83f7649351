"""Tables over an angle: CSV files of two columns, angle and value.

The first line names both columns with their units, `angle [deg], lift [mm]`. Comma, semicolon or tab
separate; with semicolon or tab a comma may be the decimal sign. Lines that begin with # are comments.
Angles may pass zero once, as 359, 0, 1.
"""

from __future__ import annotations

import codecs
import math
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from models.core.quantities import Vector

from ..errors import MistakeError
from .units import UnitError, to_unit

# Pint would read giga-radians.
GERMAN = {"Grad": "deg"}


class AngleTableError(MistakeError):
    """A file that is no such table."""


class Kind(NamedTuple):
    """The value's name and unit, the most turns that the angle spans, whose they are, and a header.

    `per_crank` is the angle over that of the crank, for a column with `crank` in its name.
    """

    value: str
    unit: str
    turns: int
    turned: str
    example: str
    per_crank: float = 1.0

    @property
    def header(self) -> str:
        return f"the first line names the columns with their units, e.g. {self.example}"


class AngleTable(NamedTuple):
    """Ascending angles (rad), values (in the kind's unit), and the step that the values have."""

    angle: Vector
    value: Vector
    rounding: float


def read_angle_table(path: Path, kind: Kind) -> AngleTable:
    """The samples of a file. AngleTableError that names the file, the line and the remedy."""
    try:
        text = _decode(path.read_bytes())
    except OSError as error:
        raise AngleTableError(f"{path}: cannot be read ({error.strerror})") from None
    if "\0" in text:
        raise AngleTableError(f"{path}: is no text file; save it as CSV; {kind.header}")
    lines = [
        (n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip() and line.lstrip()[0] != "#"
    ]
    if not lines:
        raise AngleTableError(f"{path}: is empty; {kind.header}")
    try:
        return _parse(lines, kind)
    except AngleTableError as error:
        raise AngleTableError(f"{path}: {error}") from None


def _decode(data: bytes) -> str:
    """The text of a file as spreadsheets write it: UTF-8, UTF-16 ("Unicode text"), or Windows' code page."""
    if data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        return data.decode("utf-16", "replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def _parse(lines: list[tuple[int, str]], kind: Kind) -> AngleTable:
    number, header = lines[0]
    separator = next((s for s in (";", "\t", ",") if s in header), None)
    if separator is None:
        raise AngleTableError(f"line {number}, {header.strip()!r}: has one column; {kind.header}")
    names = header.split(separator)
    angle_unit, value_unit = (
        _read_unit(names, 0, "angle", "rad", kind),
        _read_unit(names, 1, kind.value, kind.unit, kind),
    )
    if "crank" in names[0].lower():
        angle_unit *= kind.per_crank
    rows = [_read_row(n, line, separator, len(names)) for n, line in lines[1:]]
    if len(rows) < 2:
        raise AngleTableError(f"has {len(rows)} rows of numbers; a table has one for each degree or so")
    angle = _pass_zero(np.array([row[0] for row in rows]) * angle_unit, 2.0 * math.pi * kind.turns)
    value = np.array([row[1] for row in rows]) * value_unit
    _check_order(angle, lines, kind)
    if angle[-1] < angle[0]:
        angle, value = angle[::-1], value[::-1]
    return AngleTable(angle, value, _find_step([row[2] for row in rows]) * value_unit)


def _read_unit(names: list[str], column: int, what: str, unit: str, kind: Kind) -> float:
    """What the column's unit is in `unit`."""
    written = re.search(r"[\[(]\s*([^\])]+?)\s*[\])]", names[column])
    if written is None:
        raise AngleTableError(f"column {column + 1}, {names[column].strip()!r}: has no unit; {kind.header}")
    try:
        return to_unit(f"1 {GERMAN.get(written[1], written[1])}", unit)
    except UnitError:
        raise AngleTableError(
            f"column {column + 1}, {names[column].strip()!r}: is no {what}; {kind.header}"
        ) from None


def _read_row(number: int, line: str, separator: str, columns: int) -> tuple[float, float, int]:
    """Angle, value, and decimals of the value."""
    cells = [cell.strip() for cell in line.split(separator)]
    if any(cells[columns:]):
        raise AngleTableError(
            f"line {number}, {line.strip()!r}: has {len(cells)} values, the header names {columns} columns; "
            "if commas are the decimal signs, separate the columns by semicolons"
        )
    if separator != ",":
        cells = [cell.replace(",", ".") for cell in cells]
    try:
        angle, value = float(cells[0]), float(cells[1])
    except (ValueError, IndexError):
        raise AngleTableError(f"line {number}, {line.strip()!r}: must begin with two numbers") from None
    if not (math.isfinite(angle) and math.isfinite(value)):
        raise AngleTableError(f"line {number}, {line.strip()!r}: must be finite numbers")
    mantissa, _, exponent = cells[1].lower().partition("e")
    return angle, value, len(mantissa.partition(".")[2]) - int(exponent or 0)


def _pass_zero(angle: Vector, cycle: float) -> Vector:
    """The angles with the cycle added after they pass zero, as 359, 0, 1 do (or 1, 0, 359)."""
    step = np.diff(angle)
    direction = np.sign(np.median(step))
    passed = np.append(0, np.cumsum(step * direction < -0.5 * cycle))
    return np.asarray(angle + direction * cycle * passed)


def _check_order(angle: Vector, lines: list[tuple[int, str]], kind: Kind) -> None:
    step = np.diff(angle)
    wrong = np.flatnonzero(step * np.median(step) <= 0.0)
    if wrong.size:
        number, line = lines[int(wrong[0]) + 2]
        raise AngleTableError(
            f"line {number}, {line.strip()!r}: the angles must ascend (or descend) without repetition, and "
            "may pass zero once"
        )
    turned = math.degrees(abs(angle[-1] - angle[0]))
    if turned > 360.0 * kind.turns * (1.0 + 1e-9):
        raise AngleTableError(
            f"spans {turned:g} deg: must be at most {360 * kind.turns} deg of {kind.turned}"
        )


def _find_step(decimals: list[int]) -> float:
    """The step of numbers with so many decimals: that of the most precise one."""
    return float(10.0 ** -max(decimals))
