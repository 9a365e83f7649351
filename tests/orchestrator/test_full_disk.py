"""Disks without room and folders that cannot be written: nothing is lost, and nothing left half done."""

import errno
import json
import os
import shutil
import zipfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import pytest

from fmus.build import build
from fmus.native import fmu as native
from models.core.remedies import in_command_line
from orchestrator.run import checkpoint
from orchestrator.run.pipeline import resume, run
from orchestrator.scenario.files import load
from orchestrator.store import atomic_write as replacement
from orchestrator.store.journal import Journal, Recorded
from orchestrator.store.result_file import open_result
from tribocosim.cached_fmus import build_fmu, make_folder

from .commands import called, said
from .killed import EVERY
from .whole_runs import SHORT, assert_same_run, quiet, run_whole


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
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
def test_a_full_disk_is_told_and_no_record_on_it_is_lost(every, whole, tmp_path, monkeypatch):
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


def test_a_result_without_room_is_not_begun(whole, tmp_path, monkeypatch):
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


FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.fixture
def no_cache(tmp_path, monkeypatch):
    """A cache folder that cannot be: its parent is a file."""
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("TRIBOCOSIM_CACHE", str(tmp_path / "file" / "cache"))
    make_folder.cache_clear()
    return tmp_path / "file" / "cache"


def test_fmus_are_built_without_the_cache(no_cache, tmp_path, capsys):
    """The same bytes, each file once, and one line that says so."""
    one, again, other = (build_fmu(name, {}) for name in ("coupled_mass", "coupled_mass", "sprung_mass"))
    assert one == again != other
    assert one.read_bytes() == build("coupled_mass", tmp_path, {}, references=False).read_bytes()
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"tribocosim: {no_cache}: cannot be used (Not a directory), so FMUs are built")


def test_a_native_build_needs_no_cache(no_cache, tmp_path, monkeypatch):
    """It is not kept then; `--out` is not to blame."""
    monkeypatch.setattr(native, "_kernels", lambda *component: ("", ""))
    monkeypatch.setattr(native, "shared_library", lambda *contents: b"")
    done = called("fmu", "build", "coupled_mass", "--native", "--out", str(tmp_path))
    assert (done.returncode, done.stdout) == (0, f"{tmp_path / 'coupled_mass-native.fmu'}\n"), done.stderr


def test_a_package_appears_whole_or_not_at_all(tmp_path, monkeypatch):
    def full(handle):
        raise FULL

    target = tmp_path / "a.ssp"
    assert called("ssp", "export", "two-masses", "--out", str(target)).returncode == 0  # builds its FMUs
    target.unlink()
    monkeypatch.setattr(replacement.os, "fsync", full)
    done = called("ssp", "export", "two-masses", "--out", str(target))
    assert done.returncode == 2
    assert said(done) == f"tribocosim: {target}: cannot be written ({FULL.strerror}); choose another --out"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("there", [False, True])
def test_half_a_package_is_not_left(there, tmp_path, monkeypatch):
    package, folder = tmp_path / "a.ssp", tmp_path / "folder"
    assert called("ssp", "export", "two-masses", "--out", str(package)).returncode == 0
    assert called("ssp", "import", str(package), "--out", str(tmp_path / "whole")).returncode == 0
    if there:
        folder.mkdir()

    def half(archive, path):
        for name in archive.namelist()[:2]:
            archive.extract(name, path)
        raise FULL

    monkeypatch.setattr(zipfile.ZipFile, "extractall", half)
    done = called("ssp", "import", str(package), "--out", str(folder))
    assert done.returncode == 2
    assert said(done) == f"tribocosim: {folder}: cannot be written ({FULL.strerror}); choose another --out"
    assert folder.exists() == there
    assert not there or not list(folder.iterdir())
