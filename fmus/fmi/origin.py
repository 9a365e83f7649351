"""Which FMUs this user's tribocosim has built: files are known by their SHA-256 in the user's cache folder.

What a file says of itself proves nothing: whoever writes it can write that too.
"""

import contextlib
import functools
import hashlib
from pathlib import Path

from models.compile.cache_eviction import use
from models.compile.cache_folder import open_folder

SUFFIX = ".built"


def note_built(content: bytes) -> None:
    """Remember that an FMU of this content was built here, if there is a cache folder to remember it in."""
    with contextlib.suppress(OSError), open_folder("fmus") as folder:
        folder.write(_name_note(content), b"")


def is_built(content: bytes) -> bool:
    """Whether this is the content of an FMU that was built here."""
    with contextlib.suppress(OSError), open_folder("fmus") as folder:
        use(folder.path / _name_note(content))
        folder.read(_name_note(content))
        return True
    return False


def is_built_here(path: Path) -> bool:
    """Whether a file has such content; read once as long as it does not change. OSError if there is none."""
    status = path.stat()
    return _is_built_here(path, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=256)
def _is_built_here(path: Path, changed: int, size: int) -> bool:
    with contextlib.suppress(OSError):
        return is_built(path.read_bytes())
    return False


def _name_note(content: bytes) -> str:
    return f"{hashlib.sha256(content).hexdigest()}{SUFFIX}"
