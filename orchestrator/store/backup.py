"""The files that a run replaces, put aside until it has its first values."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from pathlib import Path

NAME = "replaced"


class Backup:
    """Files of `out`, moved to a folder in there: no room is taken, and after a kill the next run finds
    them."""

    def __init__(self, out: Path) -> None:
        self._out = out
        self._folder = out / NAME

    @property
    def exists(self) -> bool:
        return self._folder.is_dir()

    def take(self, files: Iterable[Path]) -> None:
        """Move these files of `out` there."""
        for file in files:
            place = self._folder / file.relative_to(self._out)
            place.parent.mkdir(parents=True, exist_ok=True)
            os.replace(file, place)

    def restore(self) -> None:
        """Move all files back."""
        for file in [path for path in self._folder.rglob("*") if path.is_file()]:
            place = self._out / file.relative_to(self._folder)
            place.parent.mkdir(exist_ok=True)
            os.replace(file, place)
        self.delete()

    def delete(self) -> None:
        shutil.rmtree(self._folder, ignore_errors=True)
