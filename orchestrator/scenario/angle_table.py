"""Tables over an angle: CSV files of two columns, angle and value.

The first line names both columns with their units, `angle [deg], lift [mm]`. Comma, semicolon or tab
separate; with semicolon or tab a comma may be the decimal sign. Lines that begin with # are comments.
Angles may pass zero once, as 359, 0, 1. What a file leaves open is chosen, and said in the table's `notes`.

Pressure tables: files of crank angle and absolute pressure (`angle_table`) of a cycle, one turn or two.

Between the points goes the monotone cubic of Fritsch and Carlson (1980), which stays between the pressures of
its ends: a spline would swing beyond them at ignition, or where a trace is coarse.
"""

import codecs
import math
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy

from models.core.quantities import Vector
from models.core.words import tally
from models.slider_crank.piston.cylinder_gas import CylinderGasParameters, CylinderParameters

from ..errors import MistakeError
from ..texts import read_bytes
from .table_header import (
    Column,
    find_crank_word,
    find_factor,
    is_doubtful_grad,
    names_angle,
    names_cam,
    names_no_shaft,
    split_column,
)
from .units import UnitError
from .values import Inserted

# A gap is longer than this many times the usual spacing, or than this angle (rad) in an irregular table.
GAP, WIDE = 3.0, math.radians(10.0)
# In a regular table a row is missing from this many times the spacing on. This share of its rows is regular.
MISSING, REGULAR = 1.5, 0.8
# So many steps nearby tell the spacing of a part that is coarser.
NEARBY = 9
MOST_ROWS = 100_000  # 3.6 thousandths of a degree
LONGEST_LINE = 5000
# No lift and no pressure is over in so many degrees; two turns of the crank in radians are 12.6.
LEAST_SPAN = 13.0
LONGEST_NUMBER = 40


class AngleTableError(MistakeError):
    """A file that is no such table."""


class Kind(NamedTuple):
    """The value's name and unit, the most turns that the angle spans, whose they are, and a header.

    `per_crank` and `per_cam` are the angle over that of the crank and of the cam, for a column that names
    one of them; the crank also for one that turns further than `turns`. `names` are what a column without a
    unit must begin with to be in `guess`.
    """

    value: str
    unit: str
    turns: int
    turned: str
    example: str
    per_crank: float = 1.0
    per_cam: float = 1.0
    names: tuple[str, ...] = ()
    guess: str = ""

    @property
    def header(self) -> str:
        return f"the first line names the columns with their units, e.g. {self.example}"


class AngleTable(NamedTuple):
    """Ascending angles (rad), values (in the kind's unit), and the step that the values have.

    `notes` say what was chosen in reading. `named`: the header says whether the angle is the cam's or the
    crank's.
    """

    angle: Vector
    value: Vector
    rounding: float
    notes: tuple[str, ...] = ()
    named: bool = False


def read_angle_table(path: Path, kind: Kind) -> AngleTable:
    """The samples of a file. AngleTableError that names the file, the line and the remedy."""
    lines = [one for one in read_lines(path, kind.header) if one[1].lstrip()[0] != "#"]
    if not lines:
        raise AngleTableError(f"{path}: is empty; {kind.header}")
    try:
        return _parse(lines, kind)
    except (AngleTableError, UnitError) as error:
        raise AngleTableError(f"{path}: {error}") from None


def read_lines(path: Path, header: str) -> list[tuple[int, str]]:
    """The numbered lines of a table that are not blank; AngleTableError with the advice `header`."""
    try:
        text = decode(read_bytes(path))
    except OSError as error:
        raise AngleTableError(f"{path}: cannot be read ({error.strerror})") from None
    except ValueError as error:
        raise AngleTableError(f"{path}: {error}; {header}") from None
    if "\0" in text:
        raise AngleTableError(f"{path}: is no text file; save it as CSV; {header}")
    lines = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip()]
    if len(lines) > MOST_ROWS or any(len(line) > LONGEST_LINE for _, line in lines):
        raise AngleTableError(
            f"{path}: has more than {MOST_ROWS} rows, or a row of more than {LONGEST_LINE} characters"
        )
    return lines


class Gap(NamedTuple):
    """Where rows are missing after row `i` of a cycle; too many of them to go on between both ends, if it is
    `wide`."""

    i: int
    cycle: float
    begin: float
    length: float
    wide: bool

    @property
    def place(self) -> str:
        begin, end = (math.degrees(angle % self.cycle) for angle in (self.begin, self.begin + self.length))
        return f"between {begin:.6g} and {end:.6g} deg"


def find_gaps(angle: Vector, cycle: float) -> list[Gap]:
    """The gaps between ascending angles (rad), and from the last to the first one, a cycle later.

    A table may be finer in a part, as indicated pressures are about the dead centre.
    """
    steps = np.diff(angle, append=angle[0] + cycle)
    spacing = float(np.median(steps))
    regular = float(np.mean(np.abs(steps / spacing - 1.0) < 0.02)) > REGULAR
    beside = np.maximum(np.roll(steps, 1), np.roll(steps, -1))
    around = np.lib.stride_tricks.sliding_window_view(np.pad(steps, NEARBY // 2, mode="wrap"), NEARBY)
    usual = np.maximum(spacing, np.median(around, axis=1))
    gaps = steps > (MISSING * usual if regular else GAP * np.maximum(spacing, beside))
    wide = steps > (GAP * usual if regular else WIDE)
    return [Gap(int(i), cycle, angle[i], steps[i], bool(wide[i])) for i in np.flatnonzero(gaps)]


def split_row(line: str, separator: str) -> list[str]:
    """The cells of a row, whose decimal sign may be a comma where another sign separates."""
    cells = [cell.strip().strip('"') for cell in line.split(separator)]
    return cells if separator == "," else [cell.replace(",", ".") for cell in cells]


def find_separator(header: str) -> str | None:
    return next((s for s in (";", "\t", ",") if s in header), None)


def decode(data: bytes) -> str:
    """The text of a file as spreadsheets write it: UTF-8, UTF-16 ("Unicode text"), or Windows' code page."""
    if data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        return data.decode("utf-16", "replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def _parse(lines: list[tuple[int, str]], kind: Kind) -> AngleTable:
    number, header = lines[0]
    separator = find_separator(header)
    if separator is None:
        raise AngleTableError(f"line {number}, {header.strip()!r}: has one column; {kind.header}")
    names = header.split(separator)
    columns = [split_column(name) for name in names]
    notes: list[str] = []
    factor = _read_unit(columns, 0, "rad", kind, notes)
    value_factor = _read_unit(columns, 1, kind.unit, kind, notes)
    rows = [_read_row(n, line, separator, len(names)) for n, line in lines[1:]]
    if len(rows) < 2:
        raise AngleTableError(
            f"has {tally(len(rows), 'row')} of numbers; a table has one for each degree or so"
        )
    written = np.array([row.angle for row in rows]) * factor
    scale = _choose_shaft(columns[0], written, kind, notes)
    angle = _pass_zero(written * scale, 2.0 * math.pi * kind.turns)
    value = np.array([row.value for row in rows]) * value_factor
    _check_order(angle, lines, kind)
    if angle[-1] < angle[0]:
        angle, value = angle[::-1], value[::-1]
    for i, name in enumerate(columns[2:], 3):
        if any(i in row.more for row in rows):
            notes.append(f"column {i}, {name.name!r}: is ignored; the {kind.value} is column 2")
    named = scale != 1.0 or names_cam(columns[0])
    return AngleTable(
        angle, value, _find_step([row.decimals for row in rows]) * value_factor, tuple(notes), named
    )


def _read_unit(columns: list[Column], i: int, unit: str, kind: Kind, notes: list[str]) -> float:
    """What the column's unit is in `unit`."""
    column, what = columns[i], kind.value if i else "angle"
    place = f"column {i + 1}, {column.written!r}"
    if column.unit is None:
        guess = kind.guess if i else "deg"
        known = any(word.startswith(kind.names) for word in column.words) if i else names_angle(column)
        if not (kind.guess and known):
            raise AngleTableError(f"{place}: has no unit; {kind.header}")
        notes.append(f"{place}: has no unit; {guess} is taken")
        return find_factor(guess, unit)
    if not i and is_doubtful_grad(column, columns):
        notes.append(f"{place}: degrees are taken; write [gon] for 400 a turn")
    try:
        return find_factor(column.unit, unit)
    except UnitError as error:
        raise AngleTableError(f"{place}: is no {what} ({error}); {kind.header}") from None


def _choose_shaft(column: Column, angle: Vector, kind: Kind, notes: list[str]) -> float:
    """What the table's angle is of the column's, which may be that of the other shaft."""
    said = f"column 1, {column.written!r}:"
    crank = f"crank angles, the cam turns by {kind.per_crank:g} of them"
    if word := find_crank_word(column):
        if kind.per_crank != 1.0 and not word.startswith("crank"):
            notes.append(f"{said} {crank}")
        return kind.per_crank
    if names_cam(column):
        if kind.per_cam != 1.0:
            notes.append(f"{said} cam angles, the crank turns by {kind.per_cam:g} of them")
        return kind.per_cam
    turned = math.degrees(float(np.ptp(_pass_zero(angle, 2.0 * math.pi * kind.turns / kind.per_crank))))
    if kind.per_crank == 1.0 or turned <= 360.0 * kind.turns * (1.0 + 1e-9):
        if names_no_shaft(column):
            whose = "crank" if kind.per_crank == 1.0 else "cam"
            notes.append(f"{said} names neither cam nor crank; taken as {whose} angles")
        return 1.0
    notes.append(f"{said} spans {turned:g} deg, so it has {crank}")
    return kind.per_crank


class _Row(NamedTuple):
    """Angle and value, decimals of the value, and the numbers of further columns that have something."""

    angle: float
    value: float
    decimals: int
    more: list[int]


def _read_row(number: int, line: str, separator: str, columns: int) -> _Row:
    cells = split_row(line, separator)
    if any(cells[columns:]):
        raise AngleTableError(
            f"line {number}, {line.strip()!r}: "
            f"has {tally(len(cells), 'value')}, the header names {tally(columns, 'column')}; "
            "if commas are the decimal signs, separate the columns by semicolons"
        )
    try:
        if max(map(len, cells[:2])) > LONGEST_NUMBER:
            raise ValueError
        angle, value = float(cells[0]), float(cells[1])
    except (ValueError, IndexError):
        raise AngleTableError(f"line {number}, {line.strip()!r}: must begin with two numbers") from None
    if not (math.isfinite(angle) and math.isfinite(value)):
        raise AngleTableError(f"line {number}, {line.strip()!r}: must be finite numbers")
    mantissa, _, exponent = cells[1].lower().partition("e")
    decimals = len(mantissa.partition(".")[2]) - int(exponent or 0)
    return _Row(angle, value, decimals, [i for i, cell in enumerate(cells[2:], 3) if cell])


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
    if turned < LEAST_SPAN:
        raise AngleTableError(
            f"spans {turned:g} deg: must be at least {LEAST_SPAN:g} deg; if its angles are radians, name "
            "their unit [rad] in the first line"
        )


def _find_step(decimals: list[int]) -> float:
    """The step of numbers with so many decimals: that of the most precise one."""
    return float(10.0 ** -max(decimals))


PRESSURE = Kind("pressure", "Pa", 2, "the crank", "angle [deg], pressure [bar]", per_cam=2.0)
TURN = 2.0 * math.pi
# Parameters of the formula, which a table replaces: a scenario that is extended may have them.
OF_FORMULA = {f.name for f in fields(CylinderGasParameters)} - {f.name for f in fields(CylinderParameters)}
# Ends of a cycle agree to this share.
AGREED = 0.05
# Points on both sides from which the slope at an end, and its spacing, follow.
BESIDE = 3


def insert_pressure_table(table: dict[str, Any]) -> Inserted:
    """The points of the table's `pressure_table`."""
    path = Path(table["pressure_table"])
    found = read_angle_table(path, PRESSURE)
    try:
        turns, angle, pressure = _close_cycle(found.angle, found.value)
        gaps = find_gaps(angle, turns * TURN)
        if wide := [gap for gap in gaps if gap.wide]:
            raise AngleTableError(f"rows are missing {wide[0].place}: add them")
    except AngleTableError as error:
        raise AngleTableError(f"{path}: {error}") from None
    columns = {
        "pressure_angle": angle,
        "point_pressure": pressure,
        "pressure_slope": _find_slopes(angle, pressure, turns * TURN),
    }
    points = {f"{name}[{i}]": float(v) for name, column in columns.items() for i, v in enumerate(column, 1)}
    missing = (f"rows are missing {gap.place}: the pressure there is interpolated" for gap in gaps)
    return Inserted(
        {"cycle_turns": float(turns), **points},
        {"pressure_points": angle.size},
        (*found.notes, *missing),
        OF_FORMULA,
    )


def _close_cycle(angle: Vector, pressure: Vector) -> tuple[int, Vector, Vector]:
    """Turns of the cycle, and the points without the last one where it is the first a cycle later."""
    if not pressure.min() > 0.0:
        raise AngleTableError(
            f"its least pressure is {pressure.min():g} Pa: must be > 0; the table has absolute pressures, so "
            "add that of the surroundings to pressures above it"
        )
    turns = 1 if angle[-1] - angle[0] <= TURN * (1.0 + 1e-9) else 2
    steps = np.diff(angle)
    spacing = float(np.median(np.r_[steps[:BESIDE], steps[-BESIDE:]]))
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
