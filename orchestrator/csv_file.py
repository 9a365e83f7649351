"""The coupled run as CSV in the FMI cross-check layout, made of its journal: the result's rows."""

from __future__ import annotations

import os
from pathlib import Path

from .journal import Recorded
from .replacement import naming, partial

ROWS = 4096  # in memory at once


def write_csv(path: Path, recorded: Recorded) -> None:
    """Write "time","instance.variable",... in SI units; the file appears when it is whole."""
    new = partial(path)
    try:
        with naming(path), new.open("w", encoding="utf-8", newline="\n", buffering=1 << 20) as file:
            quoted = (name.replace('"', '""') for name in recorded.columns)
            file.write(",".join(f'"{name}"' for name in quoted) + "\n")
            for block in recorded.blocks(ROWS):
                # repr: the shortest text that reads back as the same number.
                file.writelines(",".join(map(repr, row)) + "\n" for row in block.tolist())
        os.replace(new, path)
    finally:
        new.unlink(missing_ok=True)
