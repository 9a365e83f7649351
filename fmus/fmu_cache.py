"""FMUs that were built, kept in the user's cache folder until nobody has asked for them for a while.

A file's name has the digest of all that it is made of, so that it never is out of date; but every edit of the
code leaves the files of before behind. Whoever adds one deletes those.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
from collections.abc import Callable
from importlib import metadata
from pathlib import Path

from models.compile import cache_eviction
from models.compile.cache_eviction import use
from models.compile.cache_folder import private_folder


def cache_path(name: str, digest: str) -> Path:
    """Where the FMU made of what has this digest is kept; OSError where no such folder can be used."""
    return private_folder("fmus") / f"{name}-{digest[:16]}.fmu"


def recall(label: str, choice: str, find: Callable[[], Path]) -> Path:
    """The file that `find()` gives for this choice; found again by a note as long as no source has changed.

    To find it takes a third of a second, in which the imports of its sources are read. `choice` says all that
    the file depends on besides the sources. OSError where there is no folder to keep files in.
    """
    folder = private_folder("fmus")
    note = folder / f"{label}-{hashlib.sha256(f'{_sources()} {choice}'.encode()).hexdigest()[:16]}.note"
    use(note)
    with contextlib.suppress(OSError, UnicodeDecodeError):
        if use_cached(known := folder / note.read_text()):
            return known
    found = find()
    note.write_text(found.name)
    return found


@functools.cache
def _sources() -> str:
    """A digest of this package's files, wherever they lie."""
    top = Path(__file__).parent.parent
    digest = hashlib.sha256(metadata.version("tribocosim").encode())
    for folder in ("models", "fmus"):
        for file in sorted(top.joinpath(folder).rglob("*")):
            if file.is_file() and file.parent.name != "__pycache__":
                digest.update(f"\n{file.relative_to(top).as_posix()}\n".encode() + file.read_bytes())
    return digest.hexdigest()


def use_cached(file: Path) -> bool:
    """Whether the file exists. If so, it counts as used now, so that it is not evicted."""
    use(file)
    return file.is_file()


def tidy(folder: Path) -> None:
    """Delete FMUs, their notes and what killed builds have left, where nobody has asked for them of late."""
    cache_eviction.tidy([*folder.glob("*.fmu"), *folder.glob("*.note"), *folder.glob(".*.part")])
