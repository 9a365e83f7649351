"""Folders and disks that cannot be written: commands go on without them, or leave nothing half done."""

import errno
import os
import zipfile
from pathlib import Path

import pytest

from fmus.build import build
from fmus.native import fmu as native
from orchestrator.store import atomic_write as replacement
from tribocosim.cached_fmus import build_fmu, make_folder

from .commands import called, said

FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.fixture
def no_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache folder that cannot be: its parent is a file."""
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("TRIBOCOSIM_CACHE", str(tmp_path / "file" / "cache"))
    make_folder.cache_clear()
    return tmp_path / "file" / "cache"


def test_fmus_are_built_without_the_cache(
    no_cache: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The same bytes, each file once, and one line that says so."""
    one, again, other = (build_fmu(name, {}) for name in ("coupled_mass", "coupled_mass", "sprung_mass"))
    assert one == again != other
    assert one.read_bytes() == build("coupled_mass", tmp_path, {}, references=False).read_bytes()
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"tribocosim: {no_cache}: cannot be used (Not a directory), so FMUs are built")


def test_a_native_build_needs_no_cache(
    no_cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is not kept then; `--out` is not to blame."""
    monkeypatch.setattr(native, "_kernels", lambda *component: ("", ""))
    monkeypatch.setattr(native, "shared_library", lambda *contents: b"")
    done = called("fmu", "build", "coupled_mass", "--native", "--out", str(tmp_path))
    assert (done.returncode, done.stdout) == (0, f"{tmp_path / 'coupled_mass-native.fmu'}\n"), done.stderr


def test_a_package_appears_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(handle: int) -> None:
        raise FULL

    monkeypatch.setattr(replacement.os, "fsync", full)
    target = tmp_path / "a.ssp"
    done = called("ssp", "export", "two-masses", "--out", str(target))
    assert done.returncode == 2
    assert said(done) == f"tribocosim: {target}: cannot be written ({FULL.strerror}); choose another --out"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("there", [False, True])
def test_half_a_package_is_not_left(there: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package, folder = tmp_path / "a.ssp", tmp_path / "folder"
    assert called("ssp", "export", "two-masses", "--out", str(package)).returncode == 0
    assert called("ssp", "import", str(package), "--out", str(tmp_path / "whole")).returncode == 0
    if there:
        folder.mkdir()

    def half(archive: zipfile.ZipFile, path: Path) -> None:
        for name in archive.namelist()[:2]:
            archive.extract(name, path)
        raise FULL

    monkeypatch.setattr(zipfile.ZipFile, "extractall", half)
    done = called("ssp", "import", str(package), "--out", str(folder))
    assert done.returncode == 2
    assert said(done) == f"tribocosim: {folder}: cannot be written ({FULL.strerror}); choose another --out"
    assert folder.exists() == there
    assert not there or not list(folder.iterdir())
