"""FMUs and their reference files in the folders of the FMI Cross-Check project (rules 4.1, 9.1.5).

In fmus/{FMI version}/{cs|me}/{platform}/{tool}/{tool version}/{model}/ are the FMU and its files. The rules
are of FMI 1.0 and 2.0; for 3.0 the same folders are used, with its names of platforms.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from ..fmi.validate import info
from .files import CrossCheckError
from .inside import reference_folder

# Platforms that the rules know; FMI 3.0 names its own.
_KNOWN = ("c-code", "darwin64", "linux32", "linux64", "win32", "win64")
_KINDS = {"co-simulation": "cs", "model exchange": "me"}


def lay_out(name: str, fmu: Path, tool: str, out: Path) -> Iterator[Path]:
    """Copy the FMU file of the component `name` with its reference below `out`; the folders that were made.

    One folder for each kind and platform that the file has and the rules know. CrossCheckError if there is
    none, or no reference.
    """
    reference, found = reference_folder(name), info(fmu)
    if not reference.is_dir():
        raise CrossCheckError(
            f"{name}: has no reference results; fmus/{name}/stimulus.py says what they are to be of"
        )
    old = found.fmi_version == "2.0"
    platforms = [platform for platform in found.platforms if not old or platform in _KNOWN]
    if not platforms:
        has = ", ".join(found.platforms)
        raise CrossCheckError(
            f"{name}: the rules know no platform of this FMU ({has}), only {', '.join(_KNOWN)}"
        )
    for kind in found.kinds:
        for platform in platforms:
            place = (found.fmi_version, _KINDS[kind], platform, tool, metadata.version("tribocosim"), name)
            folder = out.joinpath("fmus", *place)
            folder.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(fmu, folder / f"{name}.fmu")
            for file in ("README.md", f"{name}_in.csv", f"{name}_ref.csv", f"{name}_ref.opt"):
                own = reference / _KINDS[kind] / file
                shutil.copyfile(own if own.is_file() else reference / file, folder / file)
            yield folder
