"""A disk without room: no record on it is lost, and the run goes on when there is room."""

import errno
import json
import os
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import pytest

from models.core.remedies import in_command_line
from orchestrator.run import checkpoint
from orchestrator.run.pipeline import run
from orchestrator.run.resume import resume
from orchestrator.scenario.files import load
from orchestrator.store.journal import Journal, Recorded
from orchestrator.store.result_file import open_result
from tribocosim.cached_fmus import build_fmu

from .killed import EVERY
from .whole_runs import SHORT, assert_same_run, quiet, run_whole


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run_whole(tmp_path_factory.mktemp("whole") / "out", SHORT)


class _Disk:
    """Of `room` bytes for journals, and none for another file once they are full."""

    def __init__(self, room: int, monkeypatch: pytest.MonkeyPatch) -> None:
        self.room = room
        self._write = Journal._put
        monkeypatch.setattr(Journal, "_put", lambda journal, data: self._put(journal, data))
        self._file = h5py.File
        monkeypatch.setattr(h5py, "File", self._opened)

    def _put(self, journal: Journal, data: bytes) -> None:
        part, self.room = data[: self.room], max(0, self.room - len(data))
        self._write(journal, part)
        if len(part) < len(data):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def _opened(self, path: Path, *arguments: Any, **options: Any) -> Any:
        """HDF5's own words about a disk that is full."""
        if not self.room:
            raise OSError(f"Unable to create file (errno = {errno.ENOSPC}, error message = 'No space')")
        return self._file(path, *arguments, **options)


@pytest.mark.parametrize("every", ["checkpoint_every=0", EVERY])
def test_a_full_disk_is_told_and_no_record_on_it_is_lost(
    every: str, whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(checkpoint, "SHARE", 1.0)
    out, scenario = tmp_path / "out", load("valve-train", [*SHORT, every])
    with monkeypatch.context() as full:
        _Disk(30_000, full)
        summary = run(scenario, out, build_fmu, quiet(), figures=False)
        assert (summary.complete, summary.exit_status) == (False, 3)
        goes_on = "goes on from the last checkpoint" if every == EVERY else "makes the result of what was"
        said = in_command_line(summary.message)
        assert f"No space left on device; free some space, then tribocosim resume {out} {goes_on}" in said
        assert json.loads((out / "summary.json").read_text())["message"] == said
    kept = Recorded(out / "unfinished" / "coupled.journal").rows
    assert kept > 1
    done = resume(out, build_fmu, quiet(), figures=False)
    if every == EVERY:
        assert_same_run(out, whole)
        return
    assert done.exit_status == 3
    with open_result(out) as tree:
        assert tree["coupled"].sizes["time"] == kept == len((out / "coupled.csv").read_text().split()) - 1


def test_a_result_without_room_is_not_begun(whole: Path, tmp_path: Path, monkeypatch: Any) -> None:
    """HDF5 would end the process where the disk is full in its midst."""
    out = tmp_path / "out"
    size = (whole / "result.nc").stat().st_size
    with monkeypatch.context() as full:
        full.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=size // 2))
        summary = run(load("valve-train", [*SHORT, EVERY]), out, build_fmu, quiet(), figures=False)
    assert (summary.complete, summary.exit_status, summary.resumable) == (False, 3, True)
    said = in_command_line(summary.message)
    assert f"{out / 'result.nc'}: No space left on device; free some space, then" in said
    assert not list(out.glob("result.nc*"))
    assert resume(out, build_fmu, quiet(), figures=False).complete
    assert_same_run(out, whole)
