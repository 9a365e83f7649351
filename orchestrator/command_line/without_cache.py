"""FMUs of commands where the cache folder cannot be used."""

from __future__ import annotations

import atexit
import functools
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

from .error_report import say


def build_without_cache(
    make: Callable[[str, Path | None, Mapping[str, int]], Path],
    name: str,
    structure: Mapping[str, int],
    error: OSError,
) -> Path:
    """As `make`, in this process's own folder, each once; OSError where there is no place for it either."""
    sizes = "".join(f"-{size}-{number}" for size, number in sorted(structure.items()))
    folder = make_folder(str(error.strerror)) / f"{make.__name__}-{name}{sizes}"
    made = list(folder.glob("*.fmu"))
    return made[0] if made else make(name, folder, structure)


@functools.cache
def make_folder(reason: str) -> Path:
    """A folder that is deleted with the end of this process; it is said once why it is needed."""
    from models.compile.cache_folder import user_cache_directory

    say(
        f"{user_cache_directory()}: cannot be used ({reason}), so FMUs are built for this command only; "
        "TRIBOCOSIM_CACHE names another folder"
    )
    kept = tempfile.TemporaryDirectory(prefix="tribocosim-fmus-")
    atexit.register(kept.cleanup)
    return Path(kept.name)
