"""Folders as the FMI Cross-Check project has them, judged by the project's own script (fmpy keeps it)."""

from __future__ import annotations

import shutil
import zipfile
from pathlib import Path

import pytest
from fmpy.cross_check.validate_vendor_repo import validate_repo

from fmus.build import REFERENCED
from fmus.cross_check.compare import compare
from fmus.cross_check.files import CrossCheckError
from fmus.cross_check.layout import lay_out


@pytest.mark.parametrize("names", [REFERENCED[:2], pytest.param(REFERENCED, marks=pytest.mark.long)])
def test_the_projects_script_finds_nothing(
    names: tuple[str, ...], fmu_files: dict[str, Path], tmp_path: Path
) -> None:
    """FMUs that run in Python, for both of their platforms."""
    made = [folder for name in names for folder in lay_out(name, fmu_files[name], "tool", tmp_path)]
    count, _, problems = validate_repo(str(tmp_path))
    assert problems == []
    assert count == len(made) == 2 * len(names)
    folder = tmp_path / "fmus/2.0/cs/linux64/tool"
    assert folder in made[0].parents
    assert sorted(path.name for path in made[0].iterdir()) == sorted(
        ["README.md", *(f"{REFERENCED[0]}{suffix}" for suffix in (".fmu", "_in.csv", "_ref.csv", "_ref.opt"))]
    )
    for path in made[0].iterdir():
        assert path.stat().st_size < 1e6


def test_platforms_that_the_rules_do_not_know_have_no_folder(
    fmu_files: dict[str, Path], tmp_path: Path
) -> None:
    fmu = tmp_path / "more.fmu"
    shutil.copyfile(fmu_files["falling_mass"], fmu)
    with zipfile.ZipFile(fmu, "a") as archive:
        archive.writestr("binaries/aarch64-linux/falling_mass.so", b"")
    folders = lay_out("falling_mass", fmu, "tool", tmp_path)
    assert [folder.parts[-4] for folder in folders] == ["linux64", "win64"]
    with zipfile.ZipFile(fmu_files["falling_mass"]) as old, zipfile.ZipFile(fmu, "w") as new:
        for name in (name for name in old.namelist() if not name.startswith("binaries/")):
            new.writestr(name, old.read(name))
        new.writestr("binaries/aarch64-linux/falling_mass.so", b"")
    with pytest.raises(CrossCheckError, match=r"know no platform of this FMU \(aarch64-linux\)"):
        list(lay_out("falling_mass", fmu, "tool", tmp_path))


def test_an_fmu_is_run_as_its_folder_says(fmu_files: dict[str, Path], tmp_path: Path) -> None:
    (folder, _) = lay_out("falling_mass", fmu_files["falling_mass"], "tool", tmp_path)
    assert [found.kind for found in compare(folder / "falling_mass.fmu")] == ["co-simulation"]
    other = Path(str(folder).replace("/cs/", "/me/"))
    other.parent.mkdir(parents=True)
    folder.rename(other)
    with pytest.raises(CrossCheckError, match="lies in a folder me, but is not for model exchange"):
        compare(other / "falling_mass.fmu")
