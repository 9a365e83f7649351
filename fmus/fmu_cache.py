"""The cache of built FMUs in the user's cache folder.

A file's name has the digest of its sources, so a cached file is never out of date. One whose content is not
what was built, as after a power cut, counts as missing. `tidy` deletes files that
were not used for a while, such as those of older code; each build that adds a file calls it.
"""

import contextlib
import functools
import hashlib
import re
from collections.abc import Callable
from importlib import metadata
from pathlib import Path

from fmus.fmi.origin import SUFFIX, is_built
from models.compile import cache_eviction
from models.compile.cache_eviction import use
from models.compile.cache_folder import UntrustedFolderError, open_folder, private_folder


def cache_path(name: str, digest: str) -> Path:
    """The path of the FMU with this digest; OSError if no cache folder can be used."""
    return private_folder("fmus") / f"{name}-{digest[:16]}.fmu"


def recall(label: str, choice: str, find: Callable[[], Path]) -> Path:
    """The file that `find()` returns for this choice, remembered in a note until a source changes.

    `find` takes a third of a second, since it reads the imports of all sources. `choice` has everything that
    the file depends on besides the sources. OSError if no cache folder can be used.
    """
    note = f"{label}-{hashlib.sha256(f'{_sources()} {choice}'.encode()).hexdigest()[:16]}.note"
    use(private_folder("fmus") / note)
    with contextlib.suppress(FileNotFoundError, UntrustedFolderError), open_folder("fmus") as folder:
        name = folder.read(note).decode("utf-8", "replace")
        if re.fullmatch(r"[\w-]+\.fmu", name) and use_cached(known := folder.path / name):
            return known
    found = find()
    with open_folder("fmus") as folder:
        folder.write(note, found.name.encode())
    return found


@functools.cache
def _sources() -> str:
    """A digest of all files of `models` and `fmus`."""
    top = Path(__file__).parent.parent
    digest = hashlib.sha256(metadata.version("tribocosim").encode())
    for folder in ("models", "fmus"):
        for file in sorted(top.joinpath(folder).rglob("*")):
            if file.is_file() and file.parent.name != "__pycache__":
                digest.update(f"\n{file.relative_to(top).as_posix()}\n".encode() + file.read_bytes())
    return digest.hexdigest()


def use_cached(file: Path) -> bool:
    """Whether the cached file is whole. If so, it counts as used now, so that it is not evicted."""
    use(file)
    with contextlib.suppress(FileNotFoundError, UntrustedFolderError), open_folder("fmus") as folder:
        return is_built(folder.read(file.name))
    return False


def tidy(folder: Path) -> None:
    """Delete FMUs, notes and parts of killed builds that were not used recently."""
    kinds = "*.fmu", "*.note", f"*{SUFFIX}", ".*.part"
    cache_eviction.tidy([file for kind in kinds for file in folder.glob(kind)])
