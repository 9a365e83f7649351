"""Long runs say what they need before they start."""

import pytest

from orchestrator.run.execute import Workload, announce
from orchestrator.scenario.files import load

from .commands import SHORT, called


def test_a_short_run_is_not_announced(tmp_path):
    assert announce(load("valve-train"), 57, tmp_path) == ""


@pytest.mark.parametrize(
    ("settings", "keys"),
    [
        (["stop_time=120"], ["24,000,000 macro steps", '"120 ms"']),
        (["stop_time=1e5", "macro_step=1 us"], ["output_step"]),
    ],
)
def test_a_long_run_is_announced_with_its_steps_or_its_records_and_a_remedy(settings, keys, tmp_path):
    line = announce(load("valve-train", settings), 57, tmp_path)
    assert all(key in line for key in keys)


def test_the_files_of_a_run_are_within_what_is_announced(tmp_path):
    """Rows of journals and CSV at once; the files' heads are not counted."""
    done = called("run", "valve-train", "--out", str(tmp_path), "--no-figures", *SHORT)
    assert done.returncode in (0, 1), done.stderr
    head, *rows = (tmp_path / "coupled.csv").read_text().splitlines(keepends=True)
    columns = head.count(",") + 1
    found = Workload.of(load("valve-train", ["stop_time=2 ms"]), columns - 1)
    assert found.steps == 400
    assert 0 <= found.records - len(rows) <= 1
    journals = 8 * (len(rows) * columns + found.steps * 7)
    assert sum(map(len, rows)) + 2 * journals < found.disk
