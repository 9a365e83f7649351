"""The libraries in native FMUs: each of its platform, with the functions of FMI and nothing besides."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from fmus.binaries import functions, platform
from fmus.fmi.libraries import libraries
from fmus.fmi.validate import validate
from fmus.native.fmu import NAMES, build
from fmus.native.machine_code import PLATFORMS

# zig's linker exports where a library of macOS begins, under two names. Libraries there are searched one by
# one, so that names in several do no harm.
OF_THE_LINKER = frozenset({"_mh_dylib_header", "__dso_handle"})


@pytest.mark.parametrize("fmi", [2, pytest.param(3, marks=pytest.mark.long)])
@pytest.mark.parametrize(
    "name", [name if name == "valve_spring" else pytest.param(name, marks=pytest.mark.long) for name in NAMES]
)
def test_all_platforms_export_the_functions_of_fmi(name: str, fmi: int, tmp_path: Path) -> None:
    path, found = build(name, tmp_path, fmi=fmi), {}
    with zipfile.ZipFile(path) as archive:
        for file in archive.namelist():
            if file.startswith("binaries/"):
                found[Path(file).parent.name] = file, libraries(archive.read(file))
    assert set(found) == {place.fmi2 if fmi == 2 else place.fmi3 for place in PLATFORMS.values()}
    for place in PLATFORMS.values():
        folder = place.fmi2 if fmi == 2 else place.fmi3
        file, (library,) = found[folder]
        assert file == f"binaries/{folder}/{name}{place.suffix}"
        assert platform(place.fmi3) == (library.format, library.processor)
        own = OF_THE_LINKER if place.suffix == ".dylib" else frozenset()
        assert library.exports == functions(fmi) | own, folder
    assert validate(path) == []
