"""Journals: rows of doubles appended to a raw file while a run goes on.

The first line is JSON: the format and what the columns are, `time` first; rows of little-endian doubles
follow. A process killed at any moment leaves whole rows and at most one begun, which is not read; an HDF5
file killed in the middle of a flush may be unreadable as a whole.
"""

import json
import os
import time as clock
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

import numpy as np

from models.core.quantities import Quantity, Vector
from models.core.words import tally

from ..errors import CheckpointError, start_over
from .atomic_write import naming

FORMAT = "tribocosim journal 1"
SUFFIX = ".journal"
HELD = 4096  # rows in memory at most: 32 kB for each column
FLUSH_SECONDS = 2.0  # what a killed process may lose without a checkpoint
TIME = Quantity("s", "time")
DOUBLE = np.dtype("<f8")
BLOCK = 1 << 20  # bytes that are read at once
# Of the rows that belong to a checkpoint: how many ("rows"), and their CRC-32 ("checksum").
Mark = Mapping[str, int]


class JournalError(CheckpointError):
    """A file that is not a journal, or lacks rows that it should have; its run can be started over."""

    def __init__(self, path: Path, fault: str) -> None:
        super().__init__(f"{path}: {fault}", start_over(path.parents[1]))


class Journal:
    """A journal being written: `variables` over their own `time`.

    `mark` continues the journal at `path` from there, forgetting later rows; JournalError if it has fewer,
    others than were written, or other columns. Rows are in memory for `held_for` (s) at most.
    """

    def __init__(
        self,
        path: Path,
        variables: Mapping[str, Quantity],
        mark: Mark | None = None,
        held_for: float = FLUSH_SECONDS,
    ) -> None:
        self.path = path
        self._held_for = held_for
        columns = {"time": TIME, **variables}
        if mark is None:
            with naming(path):
                self._file = path.open("wb", buffering=0)
                self._put(_header(columns))
            self._written = self._checksum = 0
        else:
            rows, checksum = mark["rows"], mark["checksum"]
            start = _start(path, columns, rows, checksum)
            self._file = path.open("r+b", buffering=0)
            self._file.truncate(start + rows * len(columns) * DOUBLE.itemsize)
            self._file.seek(0, os.SEEK_END)
            self._written, self._checksum = rows, checksum
        self._rows = np.empty((HELD, len(columns)), DOUBLE)
        self._held = 0
        self.flush()

    @property
    def rows(self) -> int:
        """All rows, those in memory too."""
        return self._written + self._held

    def mark(self) -> Mark:
        """Where a run goes on from, once everything up to here is on the disk."""
        self.sync()
        return {"rows": self._written, "checksum": self._checksum}

    def append(self, time: float, values: Vector) -> None:
        """One row; `values` is copied."""
        row = self._rows[self._held]
        row[0] = time
        row[1:] = values
        self._held += 1

    @property
    def due(self) -> bool:
        """It has to be flushed before another row is appended."""
        return self._held == HELD or clock.monotonic() - self._flushed >= self._held_for

    def flush(self) -> None:
        """Hand what is in memory to the operating system: from now on it survives the process."""
        with naming(self.path):
            self._write()
        self._flushed = clock.monotonic()

    def _write(self) -> None:
        """What is in memory; where there is no room for all of it, as many whole rows as there is."""
        rows, self._held = self._held, 0
        waiting: Any = self._rows[:rows]
        data = memoryview(waiting).cast("B") if rows else memoryview(b"")
        before = self._file.tell()
        try:
            self._put(data)
        except OSError:
            whole = (self._file.tell() - before) // self._rows[0].nbytes
            self._file.seek(before + whole * self._rows[0].nbytes)
            self._file.truncate()
            self._count(data, whole)
            raise
        self._count(data, rows)

    def _count(self, data: memoryview, rows: int) -> None:
        """So many rows of the data are written."""
        self._written += rows
        self._checksum = zlib.crc32(data[: rows * self._rows[0].nbytes], self._checksum)

    def _put(self, data: bytes | memoryview) -> None:
        """All of it; OSError where there is room for a part only, which is written then."""
        left = memoryview(data)
        while left:
            left = left[self._file.write(left) or 0 :]

    def sync(self) -> None:
        """Down to the disk: from now on it survives the machine."""
        self.flush()
        os.fsync(self._file.fileno())

    def close(self) -> None:
        try:
            self.flush()
        finally:
            self._file.close()


class Recorded:
    """A journal being read, whole rows only; JournalError if the file is none."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.columns, self._start = _read_header(path)
        self.rows = (path.stat().st_size - self._start) // (len(self.columns) * DOUBLE.itemsize)

    def last_time(self) -> float | None:
        """Of the last whole row (s)."""
        if not self.rows:
            return None
        width = len(self.columns) * DOUBLE.itemsize
        return float(np.fromfile(self.path, DOUBLE, 1, offset=self._start + (self.rows - 1) * width)[0])

    def compute_checksum(self, rows: int) -> int:
        """CRC-32 of the first rows."""
        left, found = rows * len(self.columns) * DOUBLE.itemsize, 0
        with self.path.open("rb") as file:
            file.seek(self._start)
            while left and (block := file.read(min(left, BLOCK))):
                left, found = left - len(block), zlib.crc32(block, found)
        return found

    def blocks(self, rows: int) -> Iterator[Vector]:
        """The rows in order, at most `rows` at a time (rows x columns)."""
        width = len(self.columns)
        with self.path.open("rb") as file:
            file.seek(self._start)
            for first in range(0, self.rows, rows):
                count = min(rows, self.rows - first)
                yield np.fromfile(file, DOUBLE, count * width).reshape(count, width)


def journals(folder: Path) -> dict[str, Path]:
    """The journals in a folder by name; a file without a whole header has no rows and is left out."""
    found = {}
    for path in sorted(folder.glob(f"*{SUFFIX}")):
        with path.open("rb") as file:
            if file.readline().endswith(b"\n"):
                found[path.name.removesuffix(SUFFIX)] = path
    return found


def find_last_time(folder: Path) -> float | None:
    """Of the last row (s) that a run has recorded in this folder; None if there is none."""
    found = journals(folder)
    return Recorded(found["coupled"]).last_time() if "coupled" in found else None


def _header(columns: Mapping[str, Quantity]) -> bytes:
    content = {name: _plain(quantity) for name, quantity in columns.items()}
    return json.dumps({"format": FORMAT, "columns": content}).encode() + b"\n"


def _plain(quantity: Quantity) -> dict[str, Any]:
    """What differs from the defaults."""
    values = ((field, getattr(quantity, field.name)) for field in fields(quantity))
    return {
        field.name: value for field, value in values if field.default is MISSING or value != field.default
    }


def _quantity(content: dict[str, Any]) -> Quantity:
    given: dict[str, Any] = {
        key: tuple(value) if key == "choices" else value for key, value in content.items()
    }
    return Quantity(**given)


def _read_header(path: Path) -> tuple[dict[str, Quantity], int]:
    """The columns, and where the rows begin."""
    try:
        with path.open("rb") as file:
            line = file.readline()
        content = json.loads(line)
        if content["format"] != FORMAT:
            raise ValueError(content["format"])
        return {name: _quantity(text) for name, text in content["columns"].items()}, len(line)
    except OSError as error:
        raise JournalError(path, f"cannot be read ({error.strerror})") from None
    except (ValueError, KeyError, TypeError, AttributeError):
        raise JournalError(path, "is not a journal of this version") from None


def _start(path: Path, columns: Mapping[str, Quantity], rows: int, checksum: int) -> int:
    """Where the rows begin; JournalError unless the first `rows` are those of the checksum."""
    found = Recorded(path)
    if list(found.columns) != list(columns):
        raise JournalError(path, "has other columns than the run")
    if found.rows < rows:
        raise JournalError(path, f"has {tally(found.rows, 'row')}, of {rows} at the checkpoint")
    if found.compute_checksum(rows) != checksum:
        raise JournalError(
            path, f"damaged: its {rows} rows up to the checkpoint are not as they were written"
        )
    return found._start
