"""Packages are unpacked into a folder of the test's own."""

from pathlib import Path

import pytest

from orchestrator.scenario.ssp import reader as imported


@pytest.fixture(autouse=True)
def unpacked_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "cache").mkdir()
    monkeypatch.setattr(imported, "private_folder", lambda name: tmp_path / "cache")
