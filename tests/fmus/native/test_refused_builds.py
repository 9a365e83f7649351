"""What cannot be made in machine code is said in one line that can be read."""

from pathlib import Path

import pytest

from fmus.native.fmu import build
from fmus.native.translate import TranslationError, translate
from tests.orchestrator.commands import called, said


def test_a_component_that_needs_python_is_refused_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(TranslationError, match=r"^ehl_line_contact: .*Python.*ehl_contact"):
        build("ehl_line_contact", tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_run_with_it_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    done = called("run", "valve-train-ehl", "--native", "--out", str(tmp_path / "out"))
    assert done.returncode == 2
    assert "components.contact.component = ehl_line_contact" in said(done)
    assert not (tmp_path / "out").exists()


@pytest.mark.long
def test_what_the_compiler_says_is_one_line_without_colours(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its error and the first line of the explanation, not the last line of all."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    with pytest.raises(TranslationError) as raised:
        translate("ehl_line_contact", {"nodes": 51})
    said = str(raised.value)
    assert said.startswith("native code of ehl_line_contact: ")
    assert "\x1b" not in said
    assert "\n" not in said
    assert "During:" not in said
