"""The coupled run as CSV, made of its journal: the result's rows, and a table of their units.

The layout is that of the FMI cross-check: one line of names, which are those of the variables, then numbers.
A unit in a name or a second line would make tools of that layout miss the variables or refuse the file, so
that units stand in a file of their own.
"""

import csv
import io
import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from .atomic_write import naming, partial, write_whole
from .coordinates import Coordinate, Extension
from .journal import Recorded

ROWS = 4096  # in memory at once


def write_csv(path: Path, units: Path, recorded: Recorded, coordinates: Mapping[str, Coordinate]) -> None:
    """Write "time","instance.variable",... in SI units and then angles in degrees, which people read; into
    `units` a line "variable","unit","description" for each column. Files appear when they are whole."""
    angles = {f"{name}_deg": one.in_degrees() for name, one in coordinates.items()}
    extension, new = Extension(recorded.columns, angles), partial(path)
    try:
        with naming(path), new.open("w", encoding="utf-8", newline="\n", buffering=1 << 20) as file:
            quoted = (name.replace('"', '""') for name in extension.columns)
            file.write(",".join(f'"{name}"' for name in quoted) + "\n")
            for block in extension.extend(recorded.blocks(ROWS)):
                # repr: the shortest text that reads back as the same number.
                file.writelines(",".join(map(repr, row)) + "\n" for row in block.tolist())
        os.replace(new, path)
    finally:
        new.unlink(missing_ok=True)
    text = io.StringIO()
    table = csv.writer(text, quoting=csv.QUOTE_ALL, lineterminator="\n")
    table.writerow(("variable", "unit", "description"))
    table.writerows((name, of.unit, of.description) for name, of in extension.columns.items())
    write_whole(units, text.getvalue().encode())


def write_rows(path: Path, rows: Iterable[Iterable[object]]) -> None:
    """Write a table, its first row the head; the file appears when it is whole."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    write_sheet(path, text.getvalue())


def write_sheet(path: Path, text: str) -> None:
    """Write a table that spreadsheets open. They take a file for UTF-8 by its first three bytes; one of
    ASCII needs none."""
    write_whole(path, text.encode("utf-8" if text.isascii() else "utf-8-sig"))
