"""A result that was written, read by h5py: the groups of a run and their variables."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from models.core.quantities import Vector

from .result_file import PROFILES, find_result


@dataclass(frozen=True)
class Group:
    """A group of a result: the names of its variables as runs call them, and what is stored of each."""

    stored: dict[str, Any]

    @property
    def names(self) -> list[str]:
        return list(self.stored)

    def read(self, name: str, rows: slice = slice(None)) -> Vector:
        """The values of a variable."""
        return np.asarray(self.stored[name][rows], dtype=np.float64)

    def attribute(self, name: str, key: str) -> str:
        """A text attribute of a variable; empty if it has none, or is not there."""
        return str(self.stored[name].attrs.get(key, "")) if name in self.stored else ""

    @property
    def rows(self) -> int:
        return int(self.stored["time"].shape[0]) if "time" in self.stored else 0


@dataclass(frozen=True)
class Records:
    """A result file: its attributes, its groups, and the profiles across each solved contact."""

    attributes: dict[str, Any]
    groups: dict[str, Group]
    profiles: dict[str, Group]


@contextmanager
def open_records(folder: Path) -> Iterator[Records]:
    """The result of the run in `folder`; MistakeError if there is none."""
    # A dataset of h5py opens ten times as fast as a variable of h5netcdf, which looks for its dimensions.
    with h5py.File(find_result(folder), "r") as file:
        groups = {
            name: Group({key.replace("\N{DIVISION SLASH}", "/"): stored for key, stored in group.items()})
            for name, group in file.items()
            if isinstance(group, h5py.Group) and name != PROFILES
        }
        profiles = {name: Group(dict(group.items())) for name, group in file.get(PROFILES, {}).items()}
        yield Records(dict(file.attrs), groups, profiles)
