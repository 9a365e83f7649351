"""Where a command's lines and its progress go."""

import subprocess
import sys
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from orchestrator import reporter
from orchestrator.run.record import FORMULA, TextRecorder

RUN = [
    *("-m", "tribocosim", "run", "two-masses", "--no-figures"),
    *("--set", "stop_time=0.1", "--set", "reference.enabled=false"),
]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="has no device that is always full")
@pytest.mark.parametrize("streams", [">&-", "2>&-", "<&-", ">&- 2>&- <&-", ">/dev/full", "| head -0"])
def test_a_run_comes_to_its_result(streams: str, tmp_path: Path) -> None:
    command = " ".join(f"'{word}'" for word in (sys.executable, *RUN, "--out", str(tmp_path / "out")))
    subprocess.run(["bash", "-c", f"{command} {streams}"], capture_output=True, check=False)
    assert '"complete": true' in (tmp_path / "out" / "summary.json").read_text("utf-8")


@pytest.mark.parametrize("text", ["=1+1", "+1", "-cmd|' /C calc'!A0", "@SUM(1)", "\t=1", "plain"])
def test_no_text_of_an_fmu_is_a_formula_of_a_spreadsheet(text: str, tmp_path: Path) -> None:
    class Side:
        def get_texts(self, names: list[str]) -> list[str]:
            return [text]

    recorder = TextRecorder(tmp_path / "texts.csv", {"one": ["name"]})
    recorder._sides = {"one": Side()}  # type: ignore[dict-item]
    recorder.begin([])
    recorder.observe(0.0, None, None)  # type: ignore[arg-type]
    recorder.end(True, "")
    cell = (tmp_path / "texts.csv").read_text("utf-8").splitlines()[1].split(",", 2)[2].strip('"')
    assert not cell.startswith(FORMULA)
    assert text in cell


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
