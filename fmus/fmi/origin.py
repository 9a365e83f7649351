"""Which FMUs this user's tribocosim has built: files are known by their SHA-256 in the user's cache folder.

What a file says of itself proves nothing: whoever writes it can write that too.
"""

from __future__ import annotations

import contextlib
import hashlib
from pathlib import Path

from models.compile.cache_eviction import use
from models.compile.cache_folder import private_folder

SUFFIX = ".built"


def note_built(content: bytes) -> None:
    """Remember that an FMU of this content was built here, if there is a cache folder to remember it in."""
    with contextlib.suppress(OSError):
        _find_note(content).touch()


def is_built_here(path: Path) -> bool:
    """Whether the file has the content of an FMU that was built here."""
    with contextlib.suppress(OSError):
        note = _find_note(path.read_bytes())
        use(note)
        return note.is_file()
    return False


def _find_note(content: bytes) -> Path:
    return private_folder("fmus") / f"{hashlib.sha256(content).hexdigest()}{SUFFIX}"
