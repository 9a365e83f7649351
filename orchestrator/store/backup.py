"""What an output folder held before a run that replaces it, put aside until that run has begun."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from pathlib import Path

NAME = "replaced"


class Earlier:
    """The files that were in `out`, in a folder there: no room is taken, and a process killed meanwhile
    leaves them for the next one."""

    def __init__(self, out: Path) -> None:
        self._out = out
        self._folder = out / NAME

    @property
    def held(self) -> bool:
        """Whether there are any."""
        return self._folder.is_dir()

    def put_aside(self, files: Iterable[Path]) -> None:
        """Move these files of `out` there."""
        for file in files:
            place = self._folder / file.relative_to(self._out)
            place.parent.mkdir(parents=True, exist_ok=True)
            os.replace(file, place)

    def put_back(self) -> None:
        """Move all to where they were."""
        for file in [path for path in self._folder.rglob("*") if path.is_file()]:
            place = self._out / file.relative_to(self._folder)
            place.parent.mkdir(exist_ok=True)
            os.replace(file, place)
        self.drop()

    def drop(self) -> None:
        """Delete them."""
        shutil.rmtree(self._folder, ignore_errors=True)
