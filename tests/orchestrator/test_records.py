"""What is recorded of a run: its end, and enough for the comparison with the reference."""

from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.run.record import OUTSIDE
from orchestrator.run.summary import Summary
from orchestrator.scenario.files import load
from orchestrator.scenario.warnings import list_warnings
from orchestrator.stepping import FixedSteps
from orchestrator.store.result_file import open_result
from tribocosim.cached_fmus import build_fmu

from .commands import IN_PROCESS

OVERRIDES = [item.removeprefix("--set=") for item in IN_PROCESS]


def _run(out: Path, *changes: str, scenario: str = "valve-train") -> Summary:
    quiet = Reporter(Console(quiet=True))
    overrides = [*changes, *(OVERRIDES if scenario == "valve-train" else [])]
    return run(load(scenario, overrides), out, build_fmu, quiet, figures=False)


def test_the_end_of_a_run_is_recorded_wherever_it_falls(tmp_path: Path) -> None:
    """100 macro steps with a record after each 30, in every group."""
    changes = ["stop_time=0.1 s", "output_step=30 ms", "reference.enabled=false", "energy.ledger=true"]
    summary = _run(tmp_path / "out", *changes, scenario="quarter-car")
    assert summary.macro_steps == 100
    with open_result(tmp_path / "out") as tree:
        for group in ("coupled", "energy"):
            assert tree[group]["time"].values == pytest.approx([0.0, 0.03, 0.06, 0.09, 0.1], rel=1e-12)
            assert tree[group]["time"].values[-1] == 0.1
    assert summary.energy
    assert summary.energy.until == 0.1


@pytest.mark.long
def test_rare_records_do_not_hide_an_error_from_the_comparison(tmp_path: Path) -> None:
    """With inputs held the load chatters, by more than its own size. Compared at t = 0, 14 ms, 28 ms it was
    0.7 % off. The error found is the one of all macro steps, up to three standard errors of an RMS estimated
    from n values (1 / sqrt(2 n) each)."""
    changes = ["master.extrapolation=hold", "stop_time=30 ms"]
    rare = _run(tmp_path / "rare", *changes, "output_step=14 ms")
    every = _run(tmp_path / "every", *changes, "output_step=5 us")
    assert rare.exit_status == every.exit_status == OUTSIDE
    with open_result(tmp_path / "rare") as tree:
        times = tree["coupled"]["time"].values
    assert times[-1] == 30e-3
    assert len(times) > 100
    assert np.diff(times).max() <= 0.3e-3 * (1.0 + 1e-9)
    found, whole = (summary.errors["contact.load"].relative_rms for summary in (rare, every))
    assert found == pytest.approx(whole, rel=3.0 / np.sqrt(2.0 * len(times)))
    assert whole > 1.0


@pytest.mark.parametrize(
    ("changes", "every", "why"),
    [
        (["output_step=20 us"], 4, None),
        (
            ["output_step=12.5 us"],
            2,
            "1.25e-05 s: is no multiple of macro_step = 5e-06 s; the interval is 1e-05 s, 2 macro steps",
        ),
        (
            ["output_step=1 us"],
            1,
            "1e-06 s: is shorter than macro_step = 5e-06 s; the interval is 5e-06 s, 1 macro",
        ),
        (["output_step=2 ms"], 240, "0.002 s: is too long for the comparison with the reference"),
        (["stop_time=1 ms"], 2, "2e-05 s: is too long for the comparison with the reference"),
        (["output_step=2 ms", "reference.enabled=false"], 400, None),
    ],
)
def test_records_at_other_times_than_asked_for_are_noticed(
    changes: list[str], every: int, why: str | None
) -> None:
    scenario = load("valve-train", changes)
    assert scenario.record_every == every
    if scenario.reference.enabled:
        assert scenario.stop_time >= 100 * every * scenario.macro_step * (1 - 1e-9)
    said = list_warnings(scenario)
    assert len(said) == (why is not None)
    assert all(line.startswith(f"output_step = {why}") for line in said)


def test_every_step_of_very_many_ends_after_it_began() -> None:
    """Of 3e7 steps the rounding of time / macro_step is above the slack of few: steps of no length came of
    it."""
    steps = FixedSteps(5e-6)
    steps._start, steps._stop = 0.0, 1e6
    for n in range(30_000_000, 30_000_100):
        end, _ = steps._find_end(n * 5e-6)
        assert end == (n + 1) * 5e-6


def test_step_control_does_not_inherit_the_records_of_equal_steps(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('extends = "valve-train"\n[step_control]\n')
    assert load("valve-train").output_step is not None
    assert load(file).output_step is None
    file.write_text('extends = "valve-train"\noutput_step = "1 ms"\n[step_control]\n')
    assert load(file).output_step == 1e-3
