"""FMUs for a command that cannot use the cache folder."""

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
    """As `make`, once for each FMU, in a temporary folder; OSError if that cannot be written either."""
    sizes = "".join(f"-{size}-{number}" for size, number in sorted(structure.items()))
    folder = make_folder(str(error.strerror)) / f"{make.__name__}-{name}{sizes}"
    made = list(folder.glob("*.fmu"))
    return made[0] if made else make(name, folder, structure)


@functools.cache
def make_folder(reason: str) -> Path:
    """Make a folder that is deleted at the end of this process; report once why it is needed."""
    from models.compile.cache_folder import user_cache_directory

    say(
        f"{user_cache_directory()}: cannot be used ({reason}), so FMUs are built for this command only; "
        "TRIBOCOSIM_CACHE names another folder"
    )
    kept = tempfile.TemporaryDirectory(prefix="tribocosim-fmus-")
    atexit.register(kept.cleanup)
    return Path(kept.name)
