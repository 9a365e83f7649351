"""Temporary folders. A process has its own in one folder, locked as long as it lives, so that a later process
deletes those of one that was killed."""

import contextlib
import functools
import os
import shutil
import tempfile
import threading
import time
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows: what is left stays
    fcntl = None  # type: ignore[assignment]

PREFIX = "tribocosim-work-"
# Between a folder's making and its lock there is less than this (s).
NEW = 60.0

_guard = threading.Lock()
_locked: dict[tuple[int, str], int | None] = {}  # by process and folder


class TemporaryFolder:
    """A new folder in `place`, or where temporary files go; `delete` or the end of a block removes it."""

    def __init__(self, place: Path | None = None) -> None:
        with _guard:
            self._process, self._top = os.getpid(), _find_locked(str(place or tempfile.gettempdir()))
            self.path = Path(tempfile.mkdtemp(dir=self._top))

    def __enter__(self) -> Path:
        return self.path

    def __exit__(self, *error: object) -> None:
        self.delete()

    def delete(self) -> None:
        if self._process != os.getpid():  # a copy of the process that has it
            return
        shutil.rmtree(self.path, ignore_errors=True)
        # Where a folder is being made, perhaps by the code in which this one is collected, the place stays.
        if not _guard.acquire(blocking=False):
            return
        try:
            with contextlib.suppress(OSError):  # others are in it
                self._top.rmdir()
                if (lock := _locked.pop((self._process, str(self._top)), None)) is not None:
                    os.close(lock)
        finally:
            _guard.release()


def _find_locked(place: str) -> Path:
    """The folder of this process in that place."""
    for process, top in _locked:
        if process == os.getpid() and os.path.dirname(top) == place and os.path.isdir(top):
            return Path(top)
    _delete_left(place)
    made = Path(tempfile.mkdtemp(prefix=PREFIX, dir=place))
    _locked[os.getpid(), str(made)] = _lock(made)
    return made


@functools.cache
def _delete_left(place: str) -> None:
    """Delete the user's folders there that no process has locked; once a process."""
    if fcntl is None:
        return
    for folder in Path(place).glob(f"{PREFIX}*"):
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
