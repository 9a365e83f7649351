"""The libraries in native FMUs: small, each of its platform, with the functions of FMI and nothing more."""

import zipfile
from pathlib import Path

import pytest

from fmus.binaries import functions, platform
from fmus.fmi.libraries import libraries
from fmus.fmi.validate import validate
from fmus.native.fmu import NAMES, build
from fmus.native.machine_code import PLATFORMS

from ..names import mark_long

# zig's linker exports where a library of macOS begins, under two names. Libraries there are searched one by
# one, so that names in several do no harm.
OF_THE_LINKER = frozenset({"_mh_dylib_header", "__dso_handle"})
# In bytes: the requirement on native FMUs. docs/theory/native-fmus.md names those that exceed it.
LIMIT = 200_000
LARGER = ("slider_crank", "piston_crank", "free_piston_crank")
LARGER_IN_FMI_3 = (*LARGER, "ehl_contact", "finger", "camshaft")


@pytest.mark.parametrize("fmi", mark_long([2, 3], [2]))
@pytest.mark.parametrize("name", mark_long(NAMES, ["valve_spring"]))
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
    assert path.stat().st_size < LIMIT or name in (LARGER if fmi == 2 else LARGER_IN_FMI_3)
