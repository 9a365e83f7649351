"""FMUs that were built, kept in the user's cache folder until nobody has asked for them for a while.

A file's name has the digest of all that it is made of, so that it never is out of date; but every edit of the
code leaves the files of before behind. Whoever adds one deletes those.
"""

from __future__ import annotations

import contextlib
import os
import time
from pathlib import Path

from models.kernel import user_cache_directory

# Longer than a run, or a pause in the work on something, so that nobody misses what is deleted: it is built
# again in seconds, natively in a minute or more.
KEPT_DAYS = 21


def cached(name: str, digest: str) -> Path:
    """Where the FMU made of what has this digest is kept."""
    return user_cache_directory() / "fmus" / f"{name}-{digest[:16]}.fmu"


def there(file: Path) -> bool:
    """Whether the file is there; then it is kept from now on. Marked before it is used, so that no other
    process deletes it meanwhile."""
    # Where the folder cannot be written nothing is deleted either.
    with contextlib.suppress(OSError):
        os.utime(file)
    return file.is_file()


def tidy(folder: Path) -> None:
    """Delete the FMUs (and what builds that were killed have left of them) that were not asked for in
    KEPT_DAYS."""
    oldest = time.time() - KEPT_DAYS * 86400.0
    for file in [*folder.glob("*.fmu"), *folder.glob(".*.part")]:
        # Another process may have been faster, or have the file open (on Windows).
        with contextlib.suppress(OSError):
            if file.stat().st_mtime < oldest:
                file.unlink()
