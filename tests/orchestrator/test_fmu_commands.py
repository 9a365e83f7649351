"""`tribocosim fmu`, runs with FMUs that are damaged or fail, and --json, which prints the result alone."""

import json
import zipfile
from pathlib import Path
from typing import Any

import pytest

import tribocosim
from fmus.native import fmu as native
from orchestrator.scenario.files import list_shipped
from tests.archives import replace_text

from .commands import SHORT, called, said


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    """The camshaft's FMU as the command builds it."""
    folder = tmp_path_factory.mktemp("fmu")
    assert called("fmu", "build", "camshaft", "--out", str(folder)).returncode == 0
    return folder / "camshaft.fmu"


def test_fmu_commands(fmu):
    assert called("fmu", "validate", str(fmu)).returncode == 0
    compared = called("fmu", "compare", str(fmu))
    assert compared.returncode == 0
    assert "agrees; largest" in compared.stdout
    lines = called("fmu", "info", str(fmu)).stdout.splitlines()
    (line,) = (line for line in lines if line.startswith("drive_angle "))
    assert line.split()[:5] == ["drive_angle", "Real", "input", "continuous", "rad"]


def test_an_fmu_is_renewed_and_another_one_replaced_with_a_word(tmp_path):
    build = ("fmu", "build", "coupled_mass", "--out", str(tmp_path))
    assert not called(*build).stderr
    assert not called(*build).stderr  # the same bytes
    file = tmp_path / "coupled_mass.fmu"
    file.write_bytes(b"of another tool")
    assert said(called(*build)) == f"tribocosim: {file}: replaced a different file of this name"
    assert zipfile.is_zipfile(file)
    train = ("fmu", "build", "--scenario", "two-masses", "--whole", "--out", str(tmp_path / "train.fmu"))
    whole = f"tribocosim: {tmp_path / 'train.fmu'}: "
    interval = f"{whole}take an output interval of 2 ms or less: a host sees no peak between its times"
    assert said(called(*train)) == interval
    other = called(*train, "--set", "components.first.parameters.mass=2").stderr.splitlines()
    assert sorted(other) == [f"{whole}replaced a different file of this name", interval]


def test_the_build_of_a_native_fmu_says_what_it_waits_for(tmp_path, monkeypatch):
    """One line where no terminal shows the steps; nothing where the FMU is in the cache."""
    monkeypatch.setenv("TRIBOCOSIM_CACHE", str(tmp_path))
    monkeypatch.setattr(native, "_kernels", lambda *component: ("", ""))
    monkeypatch.setattr(native, "shared_library", lambda *contents: b"")
    build = ("fmu", "build", "coupled_mass", "--native", "--out", str(tmp_path))
    assert said(called(*build)) == "tribocosim: building the native FMU coupled_mass (once; up to minutes)"
    assert not called(*build).stderr
    part = called("fmu", "build", "first", "--scenario", "two-masses", "--native", "--out", str(tmp_path))
    assert said(part) == "tribocosim: building the native FMU first of two-masses (once; up to minutes)"
    steps: list[str] = []
    native.build(
        "coupled_mass", tmp_path, platforms=["x86_64-linux", "x86_64-windows"], progress=steps.append
    )
    assert steps == [
        "its equations and their derivatives",
        "machine code for x86_64-linux (1 of 2)",
        "machine code for x86_64-windows (2 of 2)",
    ]


def _escaping(fmu: Path, target: Path) -> None:
    target.write_bytes(fmu.read_bytes())
    with zipfile.ZipFile(target, "a") as archive:
        archive.writestr("../escaped.txt", "outside")


def _foreign(fmu: Path, target: Path) -> None:
    """Another model: its description lacks the camshaft's variables."""
    replace_text(fmu, target, 'name="drive_angle"', 'name="steering_angle"')


@pytest.mark.parametrize("spoil", [_escaping, _foreign])
def test_an_fmu_that_leaves_its_archive_or_is_foreign_is_refused(spoil, fmu, tmp_path):  # type: ignore[no-untyped-def]
    file = tmp_path / "spoilt.fmu"
    spoil(fmu, file)
    others = [text for text in SHORT if "camshaft" not in text]
    arguments = [*others, f"--set=components.camshaft.participant={file}"]
    done = called("run", "valve-train", "--out", str(tmp_path / "out"), *arguments)
    assert done.returncode == 2
    assert said(done).startswith("tribocosim: --set components.camshaft.participant: ")
    assert not (tmp_path / "out").exists()
    assert not (tmp_path / "escaped.txt").exists()


SHORT_RUN = ["--set", "stop_time=50 ms", "--set", "reference.enabled=false", "--no-figures"]


def read(*arguments: str, status: int = 0) -> Any:
    """What the command prints, as JSON."""
    done = called(*arguments, "--json")
    assert done.returncode == status, done.stderr
    return json.loads(done.stdout)


def test_a_run_prints_its_summary(tmp_path):
    out = tmp_path / "out"
    printed = read("run", "two-masses", "--out", str(out), *SHORT_RUN)
    assert printed == json.loads((out / "summary.json").read_text())
    found = read("diagnose", str(out))
    assert found["diagnosis"]["steps"] == printed["macro_steps"]


def test_analyses_and_lists_print_their_results(tmp_path):
    assert read("scenarios").keys() == list_shipped().keys() == tribocosim.scenarios().keys()
    camshaft = read("components", "camshaft")["camshaft"]
    assert camshaft["parameters"]["lift"]["start"] == pytest.approx(8e-3)
    assert camshaft["parameters"]["law"]["start"] == "cycloidal"
    cam = read("cam", "cycloidal", "--base-radius", "30 mm", "--out", str(tmp_path / "cam"))
    assert cam["largest_lift"] == pytest.approx(8e-3, rel=1e-9)
    assert "cam" in read("analyse")
    lift = read("analyse", "cam", "--parameters")["lift"]
    assert (lift["default"], lift["unit"], lift["positive"], lift["maximum"]) == (8e-3, "m", True, None)


def test_files_that_are_no_fmus_have_their_faults(tmp_path):
    file = tmp_path / "no.fmu"
    file.write_text("no archive")
    (fault,) = read("fmu", "validate", str(file), status=1)[str(file)]["faults"]
    assert "not a zip archive" in fault
