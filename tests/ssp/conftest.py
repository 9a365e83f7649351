"""Packages are unpacked into a folder of the test's own."""

from contextlib import nullcontext

import pytest

from models.compile.cache_folder import PrivateFolder
from orchestrator.scenario.ssp import unpack


@pytest.fixture(autouse=True)
def unpacked_here(tmp_path, monkeypatch):
    (tmp_path / "cache").mkdir()
    monkeypatch.setattr(
        unpack, "open_folder", lambda name: nullcontext(PrivateFolder(tmp_path / "cache", None))
    )
