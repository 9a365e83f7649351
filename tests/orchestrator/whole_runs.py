"""Runs without interruption, to compare others with."""

import json
from collections.abc import Sequence
from pathlib import Path

import xarray
from rich.console import Console

from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.scenario.files import load
from orchestrator.store.result_file import open_result
from tribocosim.cached_fmus import build_fmu

from .commands import HERE
from .killed import EVERY

NO_REFERENCE = ["reference.enabled=false"]
SHORT = ["stop_time=4 ms", *HERE, *NO_REFERENCE]
WALL_TIMES = ("wall_time_s", "coupled_time_s", "reference_time_s", "times")


def quiet() -> Reporter:
    return Reporter(Console(quiet=True))


def run_whole(out: Path, overrides: list[str], scenario: str = "valve-train") -> Path:
    """A run without interruption."""
    run(load(scenario, [*overrides, EVERY]), out, build_fmu, quiet(), figures=False)
    return out


def assert_same_run(one: Path, two: Path, except_for: Sequence[str] = ()) -> None:
    """Both folders hold the same finished run, except for some keys of the summary."""
    assert sorted(path.name for path in one.iterdir()) == sorted(path.name for path in two.iterdir())
    assert (one / "coupled.csv").read_bytes() == (two / "coupled.csv").read_bytes()
    contacts = [json.loads((out / "summary.json").read_text())["contacts"] for out in (one, two)]
    assert contacts[0] == contacts[1]
    with open_result(one) as first, open_result(two) as second:
        xarray.testing.assert_identical(first, second)
        assert first.attrs["complete"] == 1
    summaries = [json.loads((folder / "summary.json").read_text()) for folder in (one, two)]
    for summary in summaries:
        for key in (*WALL_TIMES, *except_for):
            del summary[key]
        for effort in summary["effort"].values():  # its counts are the same
            for key in [key for key in effort if key.endswith("_s")]:
                del effort[key]
    assert summaries[0] == summaries[1]
    assert summaries[0]["complete"] is True
