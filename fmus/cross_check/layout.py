"""FMUs and their reference files in the folders of the FMI Cross-Check project (rules 4.1, 9.1.5).

In fmus/{FMI version}/{cs|me}/{platform}/{tool}/{tool version}/{model}/ are the FMU and its files. The rules
are of FMI 1.0 and 2.0; for 3.0 the same folders are used, with its names of platforms.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from ..validate import info
from .files import CrossCheckError
from .inside import folder_of

_KINDS = {"co-simulation": "cs", "model exchange": "me"}


def lay_out(name: str, fmu: Path, tool: str, out: Path) -> Iterator[Path]:
    """Copy the FMU file of the component `name` with its reference below `out`; the folders that were made.

    One folder for each kind and platform that the file has. CrossCheckError if it has no reference.
    """
    reference, found = folder_of(name), info(fmu)
    if not reference.is_dir():
        raise CrossCheckError(
            f"{name}: has no reference results; fmus/{name}/course.py says what they are to be of"
        )
    for kind in found.kinds:
        for platform in found.platforms:
            place = (found.fmi_version, _KINDS[kind], platform, tool, metadata.version("tribocosim"), name)
            folder = out.joinpath("fmus", *place)
            folder.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(fmu, folder / f"{name}.fmu")
            for file in ("README.md", f"{name}_in.csv", f"{name}_ref.csv", f"{name}_ref.opt"):
                own = reference / _KINDS[kind] / file
                shutil.copyfile(own if own.is_file() else reference / file, folder / file)
            yield folder
