"""Measured signals: CSV files of an angle or the time, the speed, and signals, each with its unit.

The first line names the columns. Lines that begin with # are comments; of them `# speed: 1000 rpm` gives the
speed of a file without a column for it, and `# signal: ...` says of a column what the option `signal` can.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from models.core.quantities import Quantity, Vector
from models.core.words import tally

from ...errors import MistakeError, Option, one_of
from ...scenario.angle_table import find_separator, read_lines, split_row
from ...scenario.table_header import Column, find_crank_word, find_factor, split_column
from ...scenario.units import UnitError, is_bare, to_unit

HEADER = "the first line names the columns with their units, e.g. speed [rpm], angle [deg], lift [mm]"
# Speeds that are nearer to each other than this are one.
SAME_SPEED = 0.01
RPM = 30.0 / math.pi
CAM, CRANK, TIME = "cam_angle", "crank_angle", "time"
# A signal that changes by less than this part of itself says nothing.
CONSTANT = 1e-9


@dataclass(frozen=True)
class Signal:
    """A column that was measured of an output "component.variable".

    It may have an unknown `offset` and `gain`: column = gain x output + offset. `noise` is its standard
    deviation in the output's unit (None: estimated).
    """

    column: str
    variable: str
    offset: bool = False
    gain: bool = False
    noise: float | None = None


@dataclass(frozen=True)
class Experiment:
    """What was measured at one speed of the flywheel (rad/s), or in one run (None).

    `positions` are angles of `shaft` (rad), or times (s). `values` (signals, positions) are in the outputs'
    units, nan where nothing was measured.
    """

    speed: float | None
    shaft: str
    positions: Vector
    values: Vector

    @property
    def place(self) -> str:
        return "" if self.speed is None else f"at {self.speed * RPM:.6g} r/min"


@dataclass(frozen=True)
class Measured:
    """Signals, and their values at every speed, in the order of the speeds."""

    signals: tuple[Signal, ...]
    experiments: tuple[Experiment, ...]

    @property
    def count(self) -> int:
        return int(sum(np.isfinite(one.values).sum() for one in self.experiments))

    @property
    def unknowns(self) -> int:
        """Offsets and gains of the signals."""
        return sum(signal.offset + signal.gain for signal in self.signals)

    def pool(self, signal: int) -> Vector:
        """All numbers of a signal."""
        every = np.concatenate([one.values[signal] for one in self.experiments])
        return np.asarray(every[np.isfinite(every)])

    def list_owners(self) -> Vector:
        """The place among the experiments of every number, signal after signal (`count`,)."""
        rows = range(len(self.signals))
        sizes = [int(np.isfinite(one.values[i]).sum()) for i in rows for one in self.experiments]
        return np.repeat(list(range(len(self.experiments))) * len(self.signals), sizes)


def parse_signal(text: str, outputs: Mapping[str, Quantity]) -> Signal:
    """Of "column = component.variable, offset, gain, noise 5 um"; the last three may be left out."""
    option = Option("signal", text)
    named, *words = (part.strip() for part in text.split(","))
    column, equals, variable = (part.strip() for part in named.partition("="))
    variable = variable if equals else column
    if variable not in outputs:
        raise MistakeError((option, f": no output {variable!r}; {one_of(outputs, variable)}"))
    found = Signal(column, variable)
    for word in words:
        kind, _, rest = word.partition(" ")
        if word == "offset":
            found = replace(found, offset=True)
        elif word == "gain":
            found = replace(found, gain=True)
        elif kind == "noise" and rest:
            found = replace(found, noise=_parse_noise(option, rest, outputs[variable].unit))
        else:
            raise MistakeError((option, f": {word!r} is none of offset, gain and noise with its value"))
    return found


def _parse_noise(option: Option, text: str, unit: str) -> float:
    try:
        noise = to_unit(text, unit, relative=True)
    except UnitError as error:
        raise MistakeError((option, f": noise {error}")) from None
    if is_bare(text) and unit not in ("", "1"):
        raise MistakeError((option, f": noise {text}: write the unit, e.g. {text} {unit}"))
    if not (noise > 0.0 and math.isfinite(noise)):
        raise MistakeError((option, f": noise {text}: must be > 0"))
    return noise


@dataclass(frozen=True)
class _File:
    """Columns and their numbers (rows, columns), and what the comments say."""

    path: Path
    columns: Sequence[Column]
    numbers: Vector
    signals: Sequence[str]
    speed: float | None


def _read_file(path: Path) -> _File:
    comments, rows = [], []
    for number, line in read_lines(path, HEADER):
        if line.lstrip()[0] == "#":
            comments.append(line.lstrip()[1:].strip())
        else:
            rows.append((number, line))
    if not rows:
        raise MistakeError(f"{path}: is empty; {HEADER}")
    separator = find_separator(rows[0][1])
    if separator is None or len(rows) < 3:
        raise MistakeError(f"{path}: has no two columns, or no two rows of numbers; {HEADER}")
    columns = [split_column(cell) for cell in rows[0][1].split(separator)]
    numbers = [_read_row(number, line, separator, len(columns), path) for number, line in rows[1:]]
    told = {
        word: [text.partition(":")[2].strip() for text in comments if text.startswith(f"{word}:")]
        for word in ("signal", "speed")
    }
    try:
        speed = to_unit(told["speed"][0], "rad/s") if told["speed"] else None
    except UnitError as error:
        raise MistakeError(f"{path}: # speed: {error}") from None
    if len(told["speed"]) > 1:
        raise MistakeError(f"{path}: # speed: is there twice; give each speed a file, or add a column of it")
    if speed is not None and is_bare(told["speed"][0]):
        raise MistakeError(f"{path}: # speed: {speed:g}: write the unit, e.g. # speed: {speed:g} rpm")
    return _File(path, columns, np.array(numbers), told["signal"], speed)


def _read_row(number: int, line: str, separator: str, columns: int, path: Path) -> list[float]:
    cells = split_row(line, separator)
    try:
        numbers = [float(cell) if cell else math.nan for cell in cells]
        if len(cells) != columns or any(map(math.isinf, numbers)):
            raise ValueError
        return numbers
    except ValueError:
        raise MistakeError(
            f"{path}: line {number}, {line.strip()[:80]!r}: must have {tally(columns, 'number')}, as the "
            "header has columns; one that was not measured stays empty"
        ) from None


def read_measured(
    paths: Sequence[Path], outputs: Mapping[str, Quantity], given: Sequence[str] = ()
) -> tuple[Measured, list[str]]:
    """The signals of files, and what was chosen in reading; MistakeError for what cannot be used.

    A column is of the output that `given`, a comment or its own name says.
    """
    files = [_read_file(path) for path in paths]
    told = [*given, *dict.fromkeys(text for file in files for text in file.signals)]
    by_column: dict[str, Signal] = {}
    for text in told:
        signal = parse_signal(text, outputs)
        by_column.setdefault(signal.column, signal)
    for file in files:
        for column in file.columns:
            if column.name in outputs:
                by_column.setdefault(column.name, Signal(column.name, column.name))
    known = {column.name: None for file in files for column in file.columns}
    for name in by_column:
        if name not in known:
            raise MistakeError((Option("signal", name), f": no such column; {one_of(known, name)}"))
    signals = tuple(by_column.values())
    notes: list[str] = []
    if not signals:
        raise MistakeError(
            f"{paths[0]}: no column is of an output ({', '.join(known)})",
            ("name one: ", Option("signal", f"{next(reversed(known))} = {next(iter(outputs), '')}")),
        )
    experiments = [one for file in files for one in _split(file, signals, outputs, notes)]
    measured = Measured(signals, tuple(sorted(experiments, key=lambda one: one.speed or 0.0)))
    _check(measured)
    return measured, notes


def _split(
    file: _File, signals: Sequence[Signal], outputs: Mapping[str, Quantity], notes: list[str]
) -> Iterator[Experiment]:
    """What a file has of every speed."""
    values = np.full((len(signals), len(file.numbers)), math.nan)
    by_name = {signal.column: i for i, signal in enumerate(signals)}
    shaft, positions, speeds = "", None, None
    for k, column in enumerate(file.columns):
        numbers = file.numbers[:, k]
        if column.name in by_name:
            i = by_name[column.name]
            values[i] = _convert(file, column, numbers, outputs[signals[i].variable].unit)
        elif positions is None and _fits(column, "rad"):
            shaft, positions = CRANK if find_crank_word(column) else CAM, numbers * _factor(column, "rad")
        elif positions is None and _fits(column, "s"):
            shaft, positions = TIME, numbers * _factor(column, "s")
        elif speeds is None and _fits(column, "rad/s"):
            speeds = numbers * _factor(column, "rad/s")
        else:
            notes.append(f"{file.path}: column {column.written!r} is not used")
    if positions is None:
        raise MistakeError(f"{file.path}: has no column of an angle or the time; {HEADER}")
    if speeds is None and file.speed is not None:
        speeds = np.full(positions.size, file.speed)
    kept = np.isfinite(positions) & np.isfinite(values).any(axis=0)
    if speeds is None:
        if shaft != TIME:
            raise MistakeError(
                f"{file.path}: has no speed; add a column such as speed [rpm], or a line '# speed: 1000 rpm'"
            )
        yield Experiment(None, shaft, positions[kept], values[:, kept])
        return
    if lost := int(np.sum(kept & ~np.isfinite(speeds))):
        notes.append(f"{file.path}: {tally(lost, 'row')} without a speed left out")
    for part in _group_speeds(speeds[kept]):
        low, high = part[[0, -1]]
        if high - low > 2.0 * SAME_SPEED * abs(low):
            raise MistakeError(
                f"{file.path}: speeds from {RPM * low:.6g} to {RPM * high:.6g} r/min have no gap between; "
                f"cycles have one speed: keep rows that are within {100.0 * SAME_SPEED:g} % of it"
            )
        own = kept & (speeds >= low) & (speeds <= high)
        yield Experiment(float(part.mean()), shaft, positions[own], values[:, own])


def _group_speeds(speeds: Vector) -> list[Vector]:
    """In ascending order, those together that have no gap between them."""
    ordered = np.sort(speeds[np.isfinite(speeds)])
    gaps = np.flatnonzero(np.diff(ordered) > SAME_SPEED * ordered[:-1])
    return [part for part in np.split(ordered, gaps + 1) if part.size]


def _fits(column: Column, unit: str) -> bool:
    try:
        return column.unit is not None and bool(_factor(column, unit))
    except UnitError:
        return False


def _factor(column: Column, unit: str) -> float:
    return find_factor(str(column.unit), unit)


def _convert(file: _File, column: Column, numbers: Vector, unit: str) -> Vector:
    """Numbers of a column in that unit; a plain number needs none."""
    if column.unit is None and unit in ("1", ""):
        return numbers
    try:
        if not unit:
            raise UnitError(f"the FMU states no unit; leave it out, with numbers in the FMU's: {column.name}")
        if column.unit is None:
            raise UnitError(f"has no unit; write it behind the name, e.g. {column.name} [{unit}]")
        one = _factor(column, unit)
        zero = to_unit(f"0 {column.unit}", unit) if unit == "K" else 0.0
    except UnitError as error:
        raise MistakeError(f"{file.path}: column {column.written!r}: {error}") from None
    return np.asarray(zero + numbers * (one - zero))


def _check(measured: Measured) -> None:
    kinds = {(one.speed is None, one.shaft) for one in measured.experiments}
    if not measured.count:
        raise MistakeError("the data have no numbers beside those of angle, time and speed")
    if any(run for run, _ in kinds) and len(measured.experiments) > 1:
        raise MistakeError("data over time without speed are of one run: give one file of them")
    if any(one.speed is not None and not one.speed > 0.0 for one in measured.experiments):
        raise MistakeError("speed: must be > 0")
    for i, signal in enumerate(measured.signals):
        values = measured.pool(i)
        if not values.size or np.ptp(values) <= CONSTANT * np.abs(values).max():
            raise MistakeError(
                f"signal {signal.column!r} is constant: it says nothing of parameters; leave its column out"
            )
