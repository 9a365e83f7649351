"""The folder `find_run_state` in a run's output folder, from which a run can be resumed.

It holds the journals and the last checkpoint, is locked while a process works on the run, and is removed
when the result is whole.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import locket

from ..errors import MistakeError

NAME, LOCK = "unfinished", "lock"


def find_run_state(out: Path) -> Path:
    """The folder of the run in `out`; it exists while the run goes on, or after it was killed."""
    return out / NAME


def format_path(out: Path) -> Path:
    """The folder for messages: relative to the working directory if inside it."""
    here = Path.cwd()
    return out.relative_to(here) if out.is_relative_to(here) else out


@contextmanager
def lock_folder(out: Path) -> Iterator[Path]:
    """The folder, made if it isn't there; MistakeError if another process works on the run.

    Removed at the end if it is empty. The lock ends with the process. OSError if it cannot be made.
    """
    folder = find_run_state(out)
    folder.mkdir(parents=True, exist_ok=True)
    lock = locket.lock_file(str(folder / LOCK), timeout=0)
    try:
        lock.acquire()
    except locket.LockError:
        raise MistakeError(f"{format_path(out)}: another process is running it; wait for its end") from None
    try:
        yield folder
    finally:
        lock.release()
        if [path.name for path in folder.iterdir()] == [LOCK]:
            (folder / LOCK).unlink()
            folder.rmdir()


def clear(folder: Path) -> None:
    """Remove what is in it but the lock, checkpoints first: journals alone are no run to be resumed."""
    for path in contents(folder):
        path.unlink()


def contents(folder: Path) -> list[Path]:
    """What is in it but the lock, checkpoints first."""
    found = (path for path in folder.iterdir() if path.name != LOCK)
    return sorted(found, key=lambda path: not path.name.startswith("checkpoint"))
