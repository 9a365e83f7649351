"""Files that are kept in the user's cache folder until nobody has used them for a while."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterable
from pathlib import Path

DAY_SECONDS = 86400.0
# Longer than a run, or a pause in the work on something, so that nobody misses what is deleted: it is made
# again in seconds, or in a minute or more.
KEPT_DAYS = 21


def use(file: Path) -> None:
    """Have the file, where there is one, kept from now on; before it is used, so that no other process
    deletes it meanwhile. A day is near enough: files that are used all the time are written to that often."""
    # Where the folder cannot be written nothing is deleted either.
    with contextlib.suppress(OSError):
        if file.stat().st_mtime < time.time() - DAY_SECONDS:
            os.utime(file)


def tidy(files: Iterable[Path]) -> None:
    """Delete those that were not used in KEPT_DAYS."""
    oldest = time.time() - KEPT_DAYS * DAY_SECONDS
    for file in files:
        # Another process may have been faster, or have the file open (on Windows).
        with contextlib.suppress(OSError):
            if file.stat().st_mtime < oldest:
                file.unlink()


def due(mark: Path) -> bool:
    """Whether a day has gone since this was last true; the file `mark` tells."""
    with contextlib.suppress(OSError):
        if time.time() - DAY_SECONDS < mark.stat().st_mtime:
            return False
    with contextlib.suppress(OSError):
        mark.touch()
        return True
    return False
