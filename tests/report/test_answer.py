"""The page of a study's answer, and the bars of others."""

import html
import re
from pathlib import Path

import pytest
import xarray
from rich.console import Console
from rich.table import Table

from orchestrator.errors import MistakeError
from orchestrator.plots.style import create_subplots, save_figure
from orchestrator.report.answer import Answer
from orchestrator.report.page import _choose_kind
from orchestrator.report.sweep import _judge
from orchestrator.reporter import Reporter

KEPT = "contact is kept up to 3000 r/min"


def _answer(folder: Path) -> Answer:
    reporter = Reporter(Console(quiet=True))
    reporter.notice(["warning: a row <b> of the lift table"])
    answer = Answer("train <1>: answer", reporter)
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
    told = "a < b: the limit <script>", "a row <b> of"
    for said in ("train <1>: answer", "fitted & known", "spring.<rate>", "45.1", *told):
        assert said in text
    assert [source[:22] for source in re.findall('src="([^"]*)"', page)] == ["data:image/png;base64,"]
    assert re.findall('href="([^"]*)"', page) == ["numbers.csv", "a.png"]


def test_a_page_that_cannot_be_written_is_named(tmp_path):
    answer = _answer(tmp_path)
    (tmp_path / "answer.html").mkdir()
    with pytest.raises(MistakeError, match=r"answer\.html: cannot be written"):
        answer.write(tmp_path, "answer.html", ())


@pytest.mark.parametrize(
    ("separation", "doubts", "lost", "kind", "said"),
    [
        (KEPT, [], 0.0, "good", KEPT),
        (KEPT, ["no steady cycle"], 0.0, "unsteady", "; no steady"),
        ("contact is lost from 2000.0 r/min", [], 0.1, "bad", "contact is lost"),
        (None, [], 0.0, "", "was not looked for"),
        (None, [], 0.1, "bad", "was not looked for"),
    ],
)
def test_the_bar_of_a_sweep_is_green_where_nothing_is_doubted(separation, doubts, lost, kind, said):
    numbers = xarray.Dataset({"contact.lost": ("speed", [0.0, lost])}, {"speed": [100.0, 200.0]})
    found = _judge(separation and {"text": separation}, doubts, numbers)
    assert (found["kind"], said in found["verdict"]) == (kind, True)


@pytest.mark.parametrize(
    ("status", "errors", "notice", "kind"),
    [
        (0, {"x": 1}, "SAE 30", "good"),
        (0, {"x": 1}, "warning: a row", "unsteady"),
        (0, {}, "", ""),
        (1, {}, "", "bad"),
    ],
)
def test_the_bar_of_a_run_is_green_where_it_is_compared_and_nothing_is_doubted(status, errors, notice, kind):
    assert _choose_kind({"exit_status": status, "errors": errors, "notices": [notice]}) == kind
