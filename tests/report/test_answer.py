"""The page of a study's answer."""

import html
import re
from pathlib import Path

import pytest
from rich.console import Console
from rich.table import Table

from orchestrator.errors import MistakeError
from orchestrator.plots.style import create_subplots, save_figure
from orchestrator.report.answer import Answer
from orchestrator.reporter import Reporter


def _answer(folder: Path) -> Answer:
    answer = Answer("train <1>: answer", Reporter(Console(quiet=True)))
    table = Table("parameter", "fitted", title="fitted & known")
    table.add_row("spring.<rate>", "45.1")
    answer.table(table)
    answer.line("a < b: the limit <script>")
    save_figure(lambda: create_subplots()[0], folder / "a.png", dpi=20)
    return answer


def test_the_page_has_what_was_said_as_it_was_said(tmp_path):
    """Names of users are text, also with signs of HTML; figures are inside, so that it loads nothing."""
    _answer(tmp_path).write(tmp_path, "answer.html", ("numbers.csv", "a.png"))
    page = (tmp_path / "answer.html").read_text("utf-8")
    text = html.unescape(re.sub("<[^>]*>", "", page))
    for said in ("train <1>: answer", "fitted & known", "spring.<rate>", "45.1", "a < b: the limit <script>"):
        assert said in text
    assert [source[:22] for source in re.findall('src="([^"]*)"', page)] == ["data:image/png;base64,"]
    assert re.findall('href="([^"]*)"', page) == ["numbers.csv", "a.png"]


def test_a_page_that_cannot_be_written_is_named(tmp_path):
    answer = _answer(tmp_path)
    (tmp_path / "answer.html").mkdir()
    with pytest.raises(MistakeError, match=r"answer\.html: cannot be written"):
        answer.write(tmp_path, "answer.html", ())
