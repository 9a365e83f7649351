"""What FMUs of others can and cannot do: memory, what they leave behind."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from orchestrator.participants import unpacked
from orchestrator.participants.unpacked import NEW, PREFIX, UnpackedFolder
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.system import build_system

from .c_fmus import fmu
from .runs import ran, scenario

linux = pytest.mark.skipif(sys.platform != "linux", reason="needs prlimit of Linux")


@linux
@pytest.mark.parametrize(("limit", "complete"), [(400, False), (None, True)])
def test_an_fmu_has_no_more_memory_than_it_is_given(
    limit: int | None, complete: bool, tmp_path: Path
) -> None:
    table = {"participant": fmu("greedy", 2, tmp_path), "process": "own"}
    table |= {} if limit is None else {"memory_limit_mb": limit}
    summary, _ = ran(scenario({"one": table}), tmp_path / "out")
    assert summary.complete is complete
    assert complete or "no memory left" in summary.message


def test_a_limit_of_memory_needs_a_process_of_its_own(tmp_path: Path) -> None:
    one = scenario({"one": {"participant": fmu("dahlquist", 2, tmp_path), "memory_limit_mb": 400}})
    with pytest.raises(ScenarioError, match=r"memory_limit_mb: .* set components\.one\.process = 'own'"):
        build_system(one)


@pytest.mark.skipif(unpacked.fcntl is None, reason="needs locks of POSIX")
def test_folders_of_killed_processes_are_deleted_by_a_later_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not those of living ones, whatever their age, nor new ones, nor what has another name."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    code = (
        "from orchestrator.participants.unpacked import *; print(UnpackedFolder().path, flush=True); input()"
    )

    def start() -> tuple[subprocess.Popen[str], Path]:
        made = subprocess.Popen(
            [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert made.stdout is not None
        return made, Path(made.stdout.readline().strip())

    (living, kept), (dead, left) = start(), start()
    dead.kill()
    dead.communicate()
    new, other = tmp_path / f"{PREFIX}new", tmp_path / "other"
    new.mkdir()
    other.mkdir()
    for folder in (kept, left, other):
        os.utime(folder, (0.0, time.time() - 2.0 * NEW))
    unpacked._delete_left.cache_clear()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    UnpackedFolder().delete()
    assert [folder.exists() for folder in (kept, left, new, other)] == [True, False, True, True]
    living.communicate("")
