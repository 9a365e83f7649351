"""Eviction from the user's cache folder: files unused for three weeks are deleted."""

import contextlib
import os
import time
from collections.abc import Iterable
from pathlib import Path

DAY_SECONDS = 86400.0
# Longer than any run and most holidays. Deleted files are rebuilt in seconds to a minute.
KEPT_DAYS = 21


def use(file: Path) -> None:
    """Mark the file, if it exists, as used now. Call it before reading: others delete unused files.

    Marks are a day coarse, so that a file in constant use is touched once a day.
    """
    # In a folder without write access nothing is deleted either.
    with contextlib.suppress(OSError):
        if file.stat().st_mtime < time.time() - DAY_SECONDS:
            os.utime(file)


def tidy(files: Iterable[Path]) -> None:
    """Delete the files that were not used in KEPT_DAYS."""
    oldest = time.time() - KEPT_DAYS * DAY_SECONDS
    for file in files:
        # Another process may have been faster, or have the file open (on Windows).
        with contextlib.suppress(OSError):
            if file.stat().st_mtime < oldest:
                file.unlink()


def due(mark: Path) -> bool:
    """True at most once a day; the time of the file `mark` is that of the last time."""
    with contextlib.suppress(OSError):
        if time.time() - DAY_SECONDS < mark.stat().st_mtime:
            return False
    with contextlib.suppress(OSError):
        mark.touch()
        return True
    return False
