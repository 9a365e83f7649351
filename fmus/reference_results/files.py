"""Reference results as files, by the rules 4.1 of FMI Cross-Check: `NAME_in.csv`, `_ref.csv`, `_ref.opt`.

CSV: names in double quotes, commas, numbers as in C, time first and never falling, no units, no comments.
"""

import io
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.core.errors import MistakeError
from models.core.quantities import Vector

REQUIRED = ("StartTime", "StopTime", "StepSize", "RelTol")


class ComparisonError(MistakeError):
    """A file that is not as the rules say; the message names it and what is wrong."""


@dataclass(frozen=True)
class Options:
    """What an .opt file says: times and steps in s; a step of 0 means a solver with variable steps."""

    start_time: float
    stop_time: float
    step_size: float
    tolerance: float
    interval: float | None = None

    def text(self) -> str:
        """The file."""
        values = zip(REQUIRED, (self.start_time, self.stop_time, self.step_size, self.tolerance), strict=True)
        lines = [f"{name}, {value!r}" for name, value in values]
        if self.interval is not None:
            lines.append(f"OutputIntervalLength, {self.interval!r}")
        return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class Table:
    """Columns by name over `times` (s)."""

    times: Vector
    columns: Mapping[str, Vector]

    def to_structured_array(self) -> NDArray[np.void]:
        """As fmpy wants inputs."""
        names = ["time", *self.columns]
        array = np.zeros(self.times.size, dtype=[(name, np.float64) for name in names])
        array["time"] = self.times
        for name, column in self.columns.items():
            array[name] = column
        return array


def csv_text(names: Sequence[str], rows: Iterable[Sequence[float]], digits: int = 15) -> str:
    """The file of these columns, numbers to so many digits."""
    buffer = io.StringIO()
    buffer.write(",".join(f'"{name}"' for name in names) + "\n")
    for row in rows:
        buffer.write(",".join(f"{value + 0.0:.{digits}g}" for value in row) + "\n")
    return buffer.getvalue()


def read_csv(text: str, name: str) -> Table:
    """The table in a CSV file called `name`. ComparisonError if it is not as the rules say."""
    lines = text.splitlines()
    names = [part.strip().strip('"') for part in lines[0].split(",")] if lines else []
    if len(names) < 2:
        raise ComparisonError(f"{name}: line 1 must have the names of time and of variables")
    rows = []
    for number, line in enumerate(lines[1:], 2):
        if not line.strip():
            continue
        try:
            row = [float(part) for part in line.split(",")]
        except ValueError:
            row = [math.nan]
        if not all(map(math.isfinite, row)):
            raise ComparisonError(f"{name}: line {number} must be finite numbers between commas")
        if len(row) != len(names):
            raise ComparisonError(f"{name}: line {number} has {len(row)} numbers: must be {len(names)}")
        rows.append(row)
    if not rows:
        raise ComparisonError(f"{name}: has no numbers")
    values = np.array(rows)
    if np.any(np.diff(values[:, 0]) < 0.0):
        at = int(np.argmax(np.diff(values[:, 0]) < 0.0)) + 3
        raise ComparisonError(f"{name}: line {at}: time falls: it must never")
    return Table(values[:, 0], {n: values[:, i].copy() for i, n in enumerate(names) if i})


def read_options(text: str, name: str) -> Options:
    """What the .opt file called `name` says. ComparisonError if something is missing or makes no sense."""
    found: dict[str, float] = {}
    for line in text.splitlines():
        key, comma, rest = line.partition(",")
        value = rest.split("//")[0].strip()
        if not comma or key.strip() not in (*REQUIRED, "OutputIntervalLength"):
            continue
        try:
            found[key.strip()] = float(value)
        except ValueError:
            raise ComparisonError(f"{name}: {key.strip()} = {value}: must be a number") from None
    for key in REQUIRED:
        if not math.isfinite(found.get(key, math.nan)):
            raise ComparisonError(f"{name}: {key} is missing: it must be a finite number")
    start, stop, step, tolerance = (found[key] for key in REQUIRED)
    if stop <= start:
        raise ComparisonError(f"{name}: StopTime = {stop:g} s: must be later than StartTime = {start:g} s")
    if not 0.0 <= step <= stop - start:
        raise ComparisonError(f"{name}: StepSize = {step:g} s: must be from 0 to {stop - start:g} s")
    if tolerance < 0.0:
        raise ComparisonError(f"{name}: RelTol = {tolerance:g}: must not be negative")
    return Options(start, stop, step, tolerance, found.get("OutputIntervalLength"))
