"""Packages are unpacked whole or not at all, and no larger than one package may be."""

import io
import os
import zipfile
from pathlib import Path

import pytest

from orchestrator.scenario.files import load
from orchestrator.scenario.ssp import unpack


def pack(files: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return stream.getvalue()


@pytest.fixture
def cache(tmp_path):
    return tmp_path / "cache"


def occupied(folder: Path) -> int:
    return sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())


@pytest.mark.parametrize("nested", [False, True])
def test_packages_inside_have_one_limit_together(nested, tmp_path, cache, monkeypatch):
    """Each is below the limit alone; nothing stays of what is refused."""
    monkeypatch.setattr(unpack, "MAXIMUM_UNPACKED_BYTES", 1_000_000)
    large = pack({"large": bytes(400_000)})
    if nested:
        inner = {"one.ssp": pack({"large": bytes(400_000), "two.ssp": pack({"x": bytes(700_000)})})}
    else:
        inner = {f"{name}.ssp": large for name in ("one", "two", "three")}
    path = tmp_path / "a.ssp"
    path.write_bytes(pack({"SystemStructure.ssd": b"", **inner}))
    with pytest.raises(ValueError, match=r"(two|three)\.ssp: .* bytes when unpacked: must be .* with"):
        load(path)
    assert occupied(cache) == 0


def test_nothing_stays_of_a_package_that_is_refused(tmp_path, cache):
    (tmp_path / "a.ssp").write_bytes(pack({"large": bytes(400_000)}))
    with pytest.raises(ValueError, match=r"SystemStructure\.ssd is missing"):
        load(tmp_path / "a.ssp")
    assert occupied(cache) < 100


@pytest.mark.parametrize("damage", [b"\0", b""])
def test_a_damaged_file_in_the_cache_is_unpacked_again(damage, tmp_path, cache):
    """As a power cut leaves it: zeroed or empty."""
    path = tmp_path / "a.ssp"
    path.write_bytes(pack({"extra.txt": b"text"}))
    folder = unpack.unpack_into_cache(path)
    before = os.stat(folder).st_ino
    assert os.stat(unpack.unpack_into_cache(path)).st_ino == before
    for file in folder.rglob("*"):
        file.write_bytes(damage * file.stat().st_size)
    assert unpack.unpack_into_cache(path) == folder
    assert (folder / "extra.txt").read_text() == "text"
