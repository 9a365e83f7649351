"""Progress of a command: one stage at a time, whose share comes from wherever the work is done."""

import io
import re

import pytest
from rich.console import Console
from rich.table import Table

import orchestrator.reporter
from orchestrator.reporter import COMPILING, Reporter, SafeConsole, follow, show_share


@pytest.fixture
def told() -> list[tuple[str, float]]:
    return []


def test_the_innermost_stage_shows_the_share_from_anywhere(told):
    """And one that is followed tells the stage around it what it does, without a line of its own."""
    show_share(0.5)  # without a stage it is nothing
    reporter = Reporter(Console(file=io.StringIO()), tell=lambda words, share: told.append((words, share)))
    with reporter.stage("search") as bar:
        show_share(0.25, ", round 1")
        with follow(bar.show).stage("check"):
            show_share(0.5, " of it")
        show_share(0.75)
    assert told == [
        ("search", 0.0), ("search, round 1", 0.25), ("search, check", 0.0), ("search, check of it", 0.5),
        ("search, check", 1.0), ("search", 0.75), ("search", 1.0),
    ]  # fmt: skip


def test_a_terminal_has_a_bar_and_a_log_has_lines_with_the_time_left(monkeypatch):
    """A part whose share begins anew is judged by itself, and by its time without compilations; a small share
    foretells nothing."""
    now = iter(range(0, 1000, 30))
    monkeypatch.setattr(orchestrator.reporter.clock, "monotonic", lambda: float(next(now)))
    file = io.StringIO()
    reporter = Reporter(Console(file=file, width=110))
    with reporter.stage("cycles"):
        for share in (0.2, 0.6, 0.1, 0.4, 0.05, 0.1):
            show_share(share)
            reporter.times[COMPILING] += 10.0
    assert file.getvalue().splitlines() == [
        "cycles", "cycles: 20 % done", "cycles: 60 % done, about 20 s left", "cycles: 10 % done",
        "cycles: 40 % done, about 40 s left", "cycles: 5 % done", "cycles: 10 % done",
    ]  # fmt: skip
    terminal = io.StringIO()
    with Reporter(Console(file=terminal, width=110, force_terminal=True)).stage("cycles"):
        show_share(0.5)
    assert "cycles ━" in re.sub(r"\x1b\[[\d;?]*[a-zA-Z]", "", terminal.getvalue())


def test_units_in_brackets_are_no_styles_of_the_console():
    console = SafeConsole(file=io.StringIO(), width=80)
    table = Table("figure [mm]")
    table.add_row("least_gap [m/s]")
    console.print(table)
    shown = console.file.getvalue()
    assert "figure [mm]" in shown
    assert "least_gap [m/s]" in shown
