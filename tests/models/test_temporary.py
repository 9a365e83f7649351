"""Temporary folders of a process."""

import tempfile

from models.compile.temporary import TemporaryFolder


def test_a_folder_that_is_collected_while_another_is_made_goes(tmp_path, monkeypatch):
    """The collector may delete one at any moment: no lock is waited for, and the other's place stays."""
    old, make = TemporaryFolder(tmp_path), tempfile.mkdtemp

    def collect(**given):
        old.delete()
        return make(**given)

    monkeypatch.setattr(tempfile, "mkdtemp", collect)
    with TemporaryFolder(tmp_path) as new:
        assert not old.path.exists()
        assert new.is_dir()
    assert not list(tmp_path.iterdir())
