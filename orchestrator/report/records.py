"""What a result file has, read group by group and variable by variable."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5netcdf
import numpy as np

from models.core.quantities import Vector

from ..errors import MistakeError
from ..store.output_folder import RESULT


@dataclass(frozen=True)
class Group:
    """A group of a result: the names of its variables as runs call them, and their attributes."""

    file: Any
    names: dict[str, str]

    def read(self, name: str) -> Vector:
        """All values of a variable."""
        return np.asarray(self.file[self.names[name]][:], dtype=np.float64)

    def attribute(self, name: str, key: str) -> str:
        """A text attribute of a variable; empty if it has none."""
        return str(self.file[self.names[name]].attrs.get(key, ""))

    @property
    def rows(self) -> int:
        return int(self.file["time"].shape[0]) if "time" in self.names else 0


@dataclass(frozen=True)
class Records:
    """A result file: its attributes and groups."""

    attributes: dict[str, Any]
    groups: dict[str, Group]


@contextmanager
def open_records(folder: Path) -> Iterator[Records]:
    """The result of the run in `folder`; MistakeError if there is none."""
    path = folder / RESULT
    if not path.is_file():
        raise MistakeError(f"{folder}: has no {RESULT}; give the output folder of a run")
    with h5netcdf.File(path, "r") as file:
        groups = {}
        for name in file.groups:
            stored = file.groups[name]
            names = {key.replace("\N{DIVISION SLASH}", "/"): key for key in stored.variables}
            groups[name] = Group(stored, names)
        yield Records(dict(file.attrs), groups)
