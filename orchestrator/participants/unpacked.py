"""Temporary folders into which FMUs are unpacked; those of processes that were killed are deleted later."""

import contextlib
import functools
import os
import shutil
import tempfile
import time
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows: what is left stays
    fcntl = None  # type: ignore[assignment]

PREFIX = "tribocosim-fmu-"
# Between a folder's making and its lock there is less than this (s).
NEW = 60.0


class UnpackedFolder:
    """A new folder, locked as long as its process lives; `delete` removes it."""

    def __init__(self) -> None:
        _delete_left(tempfile.gettempdir())
        self.path = Path(tempfile.mkdtemp(prefix=PREFIX))
        self._lock = _lock(self.path)

    def delete(self) -> None:
        shutil.rmtree(self.path, ignore_errors=True)
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None


@functools.cache
def _delete_left(top: str) -> None:
    """Delete the user's folders there that no process has locked; once a process."""
    if fcntl is None:
        return
    for folder in Path(top).glob(f"{PREFIX}*"):
        with contextlib.suppress(OSError):
            found = folder.lstat()
            if found.st_uid != os.getuid() or time.time() - found.st_mtime < NEW:
                continue
            lock = _lock(folder)
            if lock is not None:
                shutil.rmtree(folder, ignore_errors=True)
                os.close(lock)


def _lock(folder: Path) -> int | None:
    """A lock on the folder that ends with this process; None where another has it, or there are none."""
    if fcntl is None:
        return None
    place = os.open(folder, os.O_RDONLY | os.O_NOFOLLOW)
    try:
        fcntl.flock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(place)
        return None
    return place
