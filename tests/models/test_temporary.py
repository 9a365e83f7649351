"""Temporary folders of a process."""

import tempfile
from pathlib import Path
from typing import Any

import pytest

from models.compile.temporary import TemporaryFolder


def test_a_folder_that_is_collected_while_another_is_made_goes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The collector may delete one at any moment: no lock is waited for, and the other's place stays."""
    old, make = TemporaryFolder(tmp_path), tempfile.mkdtemp

    def collect(**given: Any) -> str:
        old.delete()
        return make(**given)

    monkeypatch.setattr(tempfile, "mkdtemp", collect)
    with TemporaryFolder(tmp_path) as new:
        assert not old.path.exists()
        assert new.is_dir()
    assert not list(tmp_path.iterdir())
