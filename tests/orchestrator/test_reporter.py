"""The progress of long stages."""

from io import StringIO

import pytest
from rich.console import Console

from orchestrator import reporter


@pytest.mark.parametrize("before", [0.0, 0.5])
def test_the_time_left_counts_from_where_a_stage_begins(before, monkeypatch):
    """A tenth of what is left in 30 s: the rest takes 270 s, whatever an earlier run had done."""
    times = iter([0.0, 0.0, 30.0])
    monkeypatch.setattr(reporter.clock, "monotonic", lambda: next(times, 30.0))
    said = StringIO()
    with reporter.Reporter(Console(file=said)).stage("coupled run") as bar:
        bar.show(before)
        bar.show(before + 0.1 * (1.0 - before))
    assert said.getvalue().splitlines()[1].endswith("done, about 4 min left")
