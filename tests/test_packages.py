"""Files and folders with the name of one of our packages are named, and what we start does not see them."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from models.native.translate import translate
from tribocosim.packages import NAMES

ROOT = Path(__file__).parents[1]


def python(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Python in the folder, which it searches first for modules."""
    environment = os.environ | {"PYTHONPATH": f"{folder}{os.pathsep}{ROOT}"}
    return subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, timeout=120
    )


def occupied(folder: Path, name: str, as_folder: bool) -> Path:
    """A module of the user's with that name."""
    place = folder / name if as_folder else folder / f"{name}.py"
    if as_folder:
        place.mkdir()
    (place / "__init__.py" if as_folder else place).write_text("x = 1\n")
    return place


@pytest.mark.parametrize(("name", "as_folder"), [*((name, False) for name in NAMES), (NAMES[0], True)])
def test_what_hides_a_package_is_named(name, as_folder, tmp_path):
    place = occupied(tmp_path, name, as_folder)
    done = python(tmp_path, "-m", "tribocosim", "scenarios")
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"tribocosim: {place} hides ")
    assert "rename it" in line


@pytest.mark.parametrize("name", ["models", "fmus"])
def test_what_hides_a_package_from_a_notebook_is_named(name, tmp_path):
    place = occupied(tmp_path, name, False)
    done = python(tmp_path, "-c", "import tribocosim; tribocosim.load")
    assert done.stderr.splitlines()[-1].startswith(f"ImportError: {place} hides ")


def test_a_folder_of_data_with_that_name_does_no_harm(tmp_path):
    for name in NAMES:
        (tmp_path / name).mkdir()
    done = python(tmp_path, "-m", "tribocosim", "scenarios")
    assert done.returncode == 0, done.stderr
    assert "valve-train" in done.stdout


def test_processes_that_a_run_starts_do_not_look_into_the_current_folder(tmp_path):
    """Where the command itself does not look either, as after an installation."""
    for name in NAMES:
        occupied(tmp_path, name, False)
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    settings = ["stop_time=1.0", *(f"components.{n}.process='own'" for n in ("first", "second"))]
    arguments = [word for setting in settings for word in ("--set", setting)]
    done = subprocess.run(
        [sys.executable, "-P", "-m", "tribocosim", "run", "two-masses", *arguments, "--out", "out"],
        cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=280,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "coupled.csv").exists()


def test_neither_does_the_translation_to_machine_code(tmp_path, monkeypatch):
    occupied(tmp_path, "models", False)
    monkeypatch.chdir(tmp_path)
    assert "kernel_step" in translate("coupled_mass", {})


def test_the_wheel_holds_the_packages_whole_and_runs_from_anywhere(tmp_path):
    """It is built from the files that git knows; the command then runs from an unpacked copy of it."""
    listed = subprocess.run(
        ["git", "ls-files", *NAMES, "tribocosim"], cwd=ROOT, capture_output=True, text=True
    )
    if listed.returncode:
        pytest.skip("needs a checkout with git")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", tmp_path]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True, timeout=120)
    (wheel,) = tmp_path.glob("*.whl")
    installed = tmp_path / "installed"
    with zipfile.ZipFile(wheel) as content:
        names = {name for name in content.namelist() if ".dist-info/" not in name}
        content.extractall(installed)
    assert names == {name for name in listed.stdout.split() if (ROOT / name).is_file()}
    environment = os.environ | {"PYTHONPATH": str(installed)}
    for code in ("import tribocosim as t; print(t.__file__)", "import fmus.native as n; print(n.__file__)"):
        found = subprocess.run(
            [sys.executable, "-P", "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True
        )
        assert found.stdout.startswith(str(installed)), found.stderr
    done = subprocess.run(
        [sys.executable, "-P", "-m", "tribocosim", "run", "two-masses", "--set", "stop_time=1.0"],
        cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=280,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "results" / "two-masses" / "report.html").is_file()
