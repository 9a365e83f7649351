"""The cache of built FMUs: what is used stays, what was not for weeks goes."""

import pytest

from fmus.build import build
from models.compile.cache_eviction import KEPT_DAYS

from ..aged import aged

NOTES = {".note", ".built"}  # of what was asked for, and of what was built here


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("TRIBOCOSIM_CACHE", str(tmp_path))
    return tmp_path / "fmus"


def test_what_was_not_asked_for_goes_when_another_fmu_is_added(cache):
    used, unused = build("coupled_mass"), build("spring_stop")
    for file in (used, unused):
        aged(file, KEPT_DAYS + 1)
    rest = aged(cache / ".camshaft-rest.part", KEPT_DAYS + 1)
    young = [aged(cache / "other-0.fmu", KEPT_DAYS - 1), aged(cache / ".camshaft-now.part", 0.0)]
    foreign = aged(cache / "notes.txt", 1000.0)
    assert build("coupled_mass") == used  # asked for again
    added = build("falling_mass")
    assert {file for file in cache.iterdir() if file.suffix not in NOTES} == {used, added, foreign, *young}
    assert not rest.exists()


def test_a_deleted_fmu_is_built_again(cache):
    file = build("coupled_mass")
    content = file.read_bytes()
    file.unlink()
    assert build("coupled_mass").read_bytes() == content


@pytest.mark.parametrize("damage", [b"\0", b"", "half"])
@pytest.mark.parametrize("kind", ["fmu", "note", "built"])
def test_a_damaged_file_is_built_again(damage, kind, cache):
    """As a power cut leaves it: zeroed, empty or cut."""
    file = build("coupled_mass")
    content = file.read_bytes()
    for damaged in cache.glob(f"*.{kind}"):
        whole = damaged.read_bytes()
        damaged.write_bytes(whole[: len(whole) // 2] if isinstance(damage, str) else damage * len(whole))
    assert build("coupled_mass").read_bytes() == content


def test_a_note_leads_to_no_file_elsewhere(cache):
    file = build("coupled_mass")
    (cache.parent / "other.fmu").write_bytes(file.read_bytes())
    for note in cache.glob("*.note"):
        note.write_text("../other.fmu")
    assert build("coupled_mass") == file


def test_a_known_fmu_is_found_by_its_note_until_a_source_changes(cache, monkeypatch):
    file = build("coupled_mass")
    packed: list[str] = []

    def collect_files(name, *rest):
        packed.append(name)
        return {"modelDescription.xml": b"other"}

    monkeypatch.setattr("fmus.build.collect_files", collect_files)
    assert build("coupled_mass") == file
    assert not packed
    monkeypatch.setattr("fmus.fmu_cache._sources", lambda: "edited")
    assert build("coupled_mass") != file
    assert packed == ["coupled_mass"]
