"""Files that are replaced as a whole: whoever reads one, or is killed, finds the old or the new one."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path


def replace(path: Path, content: bytes) -> None:
    """Give the file this content, down to the disk."""
    new = partial(path)
    with new.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    os.replace(new, path)
    # The name as well; on Windows a folder cannot be opened.
    with contextlib.suppress(PermissionError):
        folder = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def partial(path: Path) -> Path:
    """The name of what is not whole yet."""
    return path.with_name(f"{path.name}.partial")
