"""The shared library of an FMU for this machine."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import fmpy

from .description import Description


def list_libraries(names: Sequence[str], about: Description) -> list[str]:
    """The paths among `names` in the archive that are libraries for this platform."""
    here = fmpy.platform_tuple if about.version == "3.0" else fmpy.platform
    return [
        name
        for name in names
        if name.startswith(f"binaries/{here}/")
        and name.count("/") == 2
        and name.endswith(fmpy.sharedLibraryExtension)
    ]


def find_library(names: Sequence[str], about: Description) -> str:
    """The library of the model identifier's name, or else the only one; empty if there is none."""
    libraries = list_libraries(names, about)
    wanted = f"{about.identifier}{fmpy.sharedLibraryExtension}"
    named = [name for name in libraries if name.endswith(f"/{wanted}")]
    return (named or (libraries if len(libraries) == 1 else [""]))[0]


def open_library(kind: Any, name: str, about: Description, folder: str) -> Any:
    """fmpy's object of class `kind` for the FMU that is unpacked in `folder`."""
    root = Path(folder)
    names = [path.relative_to(root).as_posix() for path in sorted(root.glob("binaries/*/*"))]
    found = find_library(names, about)
    return kind(
        guid=about.token,
        unzipDirectory=folder,
        modelIdentifier=about.identifier,
        instanceName=name,
        libraryPath=str(root.absolute() / found) if found else None,
    )
