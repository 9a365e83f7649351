"""Nothing is read from a cache folder that another user may have written: what lies there is run."""

import os
import shutil
import stat
from pathlib import Path

import pytest

from fmus.build import build
from models.compile import cache_folder
from models.compile.cache_folder import SAID, UntrustedFolderError, open_folder, private_folder
from models.compile.kernel import COMPILED
from orchestrator.scenario import units
from tribocosim.cached_fmus import build_fmu, make_folder

from .forked import Forked

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.skipif(os.name != "posix", reason="folders have no mode that says who may write")


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """The cache folder, which isn't there yet."""
    monkeypatch.setenv("TRIBOCOSIM_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv(SAID, "")
    make_folder.cache_clear()
    return tmp_path / "cache"


def mode(folder: Path) -> int:
    return stat.S_IMODE(folder.stat().st_mode)


@pytest.fixture
def open_mask():
    """The umask that would let everyone write."""
    before = os.umask(0)
    yield
    os.umask(before)


def test_folders_are_made_for_their_user_alone(tmp_path, monkeypatch, open_mask):
    """With those above them, whatever the umask."""
    monkeypatch.setenv("TRIBOCOSIM_CACHE", str(tmp_path / "above" / "cache"))
    folder = private_folder("kernels")
    assert folder == tmp_path / "above" / "cache" / "kernels"
    assert [mode(place) for place in (folder, *folder.parents[:2])] == [0o700] * 3


@pytest.mark.parametrize(("place", "writable"), [("cache", 0o770), ("cache/kernels", 0o1707)])
def test_a_folder_that_others_may_write_is_refused(place, writable, cache, capsys):
    """With one message, which says which folder it is and what to do."""
    folder = private_folder("kernels")
    (cache.parent / place).chmod(writable)
    for _ in range(2):
        with pytest.raises(UntrustedFolderError):
            private_folder("kernels")
    (line,) = capsys.readouterr().err.splitlines()
    assert f"{cache.parent / place}: " in line
    assert "TRIBOCOSIM_CACHE" in line
    (cache.parent / place).chmod(0o755)
    assert private_folder("kernels") == folder


@pytest.mark.parametrize("writable", [0o777, 0o770, 0o720, 0o702])
def test_a_folder_in_one_that_others_may_write_is_refused(writable, cache, tmp_path, monkeypatch):
    """They could put another in its place, but for the sticky bit; however far above it is."""
    for place in (cache, cache / "deep" / "er"):
        monkeypatch.setenv("TRIBOCOSIM_CACHE", str(place))
        tmp_path.chmod(writable)
        with pytest.raises(UntrustedFolderError, match=f"'{tmp_path}'"):
            private_folder("kernels")
        tmp_path.chmod(writable | stat.S_ISVTX)
        private_folder("kernels")


@pytest.mark.skipif(os.name == "posix" and os.getuid() != 0, reason="only root gives folders away")
@pytest.mark.parametrize("sticky", [0, stat.S_ISVTX])
def test_a_folder_in_one_of_another_user_is_refused(sticky, cache, tmp_path):
    os.chown(tmp_path, 12345, 0)
    tmp_path.chmod(0o755 | sticky)
    with pytest.raises(UntrustedFolderError, match="another user"):
        private_folder("kernels")


def test_what_was_checked_is_what_is_read(cache):
    """Although another folder takes its place between the check and the reading."""
    with open_folder("kernels") as folder:
        folder.write("file", b"own")
        folder.path.rename(cache / "before")
        folder.path.mkdir()
        (folder.path / "file").write_bytes(b"planted")
        assert folder.read("file") == b"own"
        folder.write("other", b"own")
    assert [file.name for file in folder.path.iterdir()] == ["file"]
    assert mode(cache / "before" / "other") == 0o600


@pytest.mark.parametrize("kind", ["writable", "link", "pipe", "folder"])
def test_a_file_that_others_may_have_written_is_not_read(kind, cache):
    with open_folder("kernels") as folder:
        file = folder.path / "file"
        if kind == "link":
            file.symlink_to(cache.parent / "elsewhere")
            (cache.parent / "elsewhere").write_bytes(b"planted")
        elif kind == "pipe":
            os.mkfifo(file)
        elif kind == "folder":
            file.mkdir()
        else:
            file.write_bytes(b"planted")
            file.chmod(0o666)
        with pytest.raises(OSError):  # noqa: PT011
            folder.read("file")
        with pytest.raises(UntrustedFolderError):
            folder.check_files()


def test_a_folder_of_another_user_is_refused(cache, monkeypatch):
    private_folder("kernels")
    monkeypatch.setattr(cache_folder.os, "getuid", lambda: os.stat(cache).st_uid + 1)
    with pytest.raises(UntrustedFolderError, match="another user"):
        private_folder("kernels")


def test_a_link_is_judged_by_where_it_leads(cache, tmp_path):
    (tmp_path / "open").mkdir()
    (tmp_path / "open").chmod(0o777)
    cache.symlink_to(tmp_path / "open")
    with pytest.raises(UntrustedFolderError, match="open"):
        private_folder("kernels")


KERNEL = """
from models.compile.kernel import kernel

@kernel
def twice(x):
    return 2.0 * x

print(twice(3.0))
"""


@pytest.mark.skipif(not COMPILED, reason="there is nothing to keep without numba")
def test_kernels_are_neither_read_from_such_a_folder_nor_written_to_it(tmp_path):
    """A file planted there, which runs code when it is unpickled and has the right checksum, is not read."""
    import hashlib
    import pickle

    cache, mark = tmp_path / "cache", tmp_path / "mark"

    class Planted:
        def __reduce__(self):
            return os.mkdir, (str(mark),)

    def run():
        return Forked(tmp_path, [ROOT], KERNEL, {"TRIBOCOSIM_CACHE": str(cache)}).said()

    assert run() == "6.0\n"
    (file,) = cache.rglob("twice-*.nbc")
    payload = pickle.dumps(Planted())
    file.write_bytes(hashlib.sha256(payload).digest() + payload)
    cache.chmod(0o777)
    before = sorted(cache.rglob("*"))
    assert run() == "6.0\n"
    assert not mark.exists()
    assert sorted(cache.rglob("*")) == before


def test_fmus_in_such_a_folder_are_not_taken(cache, capsys):
    """They are built for this process alone."""
    planted = build("coupled_mass")
    content = planted.read_bytes()
    planted.write_bytes(b"planted")
    cache.chmod(0o777)
    made = build_fmu("coupled_mass", {})
    assert made != planted
    assert made.read_bytes() == content
    assert f"{cache}: " in capsys.readouterr().err
    assert build("coupled_mass", cache.parent, references=False).read_bytes() == content


def test_the_list_of_units_is_not_read_from_such_a_folder(cache):
    cache.mkdir()
    cache.chmod(0o777)
    units._load_registry.cache_clear()
    assert units.to_unit("8 cm", "m") == 0.08
    assert list(cache.iterdir()) == []
    units._load_registry.cache_clear()
    shutil.rmtree(cache)
    assert units.to_unit("9 cm", "m") == 0.09
    assert [path.name.partition("-")[0] for path in cache.iterdir()] == ["pint"]
