"""--json: standard output is the result and nothing else."""

import json
from pathlib import Path
from typing import Any

import pytest

import tribocosim
from orchestrator.scenario.files import list_shipped

from .commands import called

SHORT = ["--set", "stop_time=50 ms", "--set", "reference.enabled=false", "--no-figures"]


def read(*arguments: str, status: int = 0) -> Any:
    """What the command prints, as JSON."""
    done = called(*arguments, "--json")
    assert done.returncode == status, done.stderr
    return json.loads(done.stdout)


def test_a_run_prints_its_summary(tmp_path: Path) -> None:
    out = tmp_path / "out"
    printed = read("run", "two-masses", "--out", str(out), *SHORT)
    assert printed == json.loads((out / "summary.json").read_text())
    found = read("diagnose", str(out))
    assert found["diagnosis"]["steps"] == printed["macro_steps"]


def test_analyses_and_lists_print_their_results(tmp_path: Path) -> None:
    assert read("scenarios").keys() == list_shipped().keys() == tribocosim.scenarios().keys()
    camshaft = read("components", "camshaft")["camshaft"]
    assert camshaft["parameters"]["lift"]["start"] == pytest.approx(8e-3)
    assert camshaft["parameters"]["law"]["start"] == "cycloidal"
    cam = read("cam", "cycloidal", "--base-radius", "30 mm", "--out", str(tmp_path / "cam"))
    assert cam["largest_lift"] == pytest.approx(8e-3, rel=1e-9)
    assert "cam" in read("analyse")
    assert read("analyse", "cam", "--parameters")["lift"]["unit"] == "m"


def test_a_mistake_prints_nothing(tmp_path: Path) -> None:
    done = called("run", "two-mases", "--json", "--out", str(tmp_path / "out"))
    assert (done.returncode, done.stdout) == (2, "")
    assert "two-masses" in done.stderr


def test_files_that_are_no_fmus_have_their_faults(tmp_path: Path) -> None:
    file = tmp_path / "no.fmu"
    file.write_text("no archive")
    (fault,) = read("fmu", "validate", str(file), status=1)[str(file)]["faults"]
    assert "not a zip archive" in fault
