"""Long runs say what they need before they start, and how long they will take."""

import itertools

import numpy as np
import pytest

from orchestrator.engine.step import Step
from orchestrator.run import execute
from orchestrator.run.execute import Forecast, Workload, announce
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


@pytest.mark.parametrize(("speed", "said"), [(1e-3, ["the coupled run will take about 17 min"]), (1.0, [])])
def test_the_time_of_a_run_is_forecast_from_its_speed(speed, said, monkeypatch):
    """At `speed` seconds of the model in a second, a run of 1 s."""
    seconds = itertools.count()
    monkeypatch.setattr(execute.clock, "monotonic", lambda: float(next(seconds)))
    lines: list[str] = []
    forecast = Forecast(1.0, lines.append)
    for k in range(4):
        forecast.observe(k * speed, lambda: np.zeros(0), Step(k * speed, speed, 1))
    assert [line.partition(" at this")[0] for line in lines] == said


def test_time_spent_on_compiling_is_no_part_of_the_forecast(monkeypatch):
    """One step takes an hour, in which kernels are compiled; the others take a second for 10 ms of 1 s."""
    seconds = iter([0.0, 3600.0, 3601.0, 3602.0, 3603.0])
    monkeypatch.setattr(execute.clock, "monotonic", lambda: next(seconds))
    lines: list[str] = []
    forecast = Forecast(1.0, lines.append)
    forecast.observe(0.0, lambda: np.zeros(0), Step(0.0, 0.0, 0))
    forecast.restart()
    for k in range(1, 5):
        forecast.observe(0.01 * k, lambda: np.zeros(0), Step(0.01 * k, 0.01, 1))
    assert [line.partition(" at this")[0] for line in lines] == ["the coupled run will take about 97 s"]
