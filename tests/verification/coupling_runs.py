"""Around a run: checkpoint and resume, what limited its steps, and the benchmark against other tools."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from orchestrator.diagnosis import RULES
from orchestrator.work_precision.methods import METHODS
from orchestrator.work_precision.problem import PROBLEMS
from tests.orchestrator.test_resume import RUNS, _same, _whole

from .shell import tribocosim
from .table import ROOT, Row

RESUME = "orchestrator/test_resume.py::"
DIAGNOSIS = "orchestrator/test_diagnosis.py::"
PRECISION = "orchestrator/test_work_precision.py::"
SEED, KILLS = "5", "4"
PEERS = {"ecos": "ecospy", "libcosim": "libcosimpy", "a plain fmpy script": "fmpy"}


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as name:
        for number, run in enumerate(RUNS):
            yield _killed(run, Path(name) / str(number))
        yield _diagnosis(Path(name) / "controlled")
    yield _benchmark()


def _killed(name: str, folder: Path) -> Row:
    """The same run with and without kills; every bit of result, CSV and summary has to agree."""
    scenario, overrides = RUNS[name]
    whole = _whole(folder / "whole", overrides, scenario)
    out = folder / "killed"
    command = [sys.executable, "-m", "tests.orchestrator.killed", str(out), SEED, KILLS, scenario, *overrides]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    *kills, end = done.stdout.splitlines() or [done.stderr[-200:]]
    try:
        _same(out, whole)
        same = True
    except (AssertionError, OSError):
        same = False
    times = ", ".join(
        "none" if float(t) < 0.0 else f"{float(t):.4g} s" for t in (k.split()[1] for k in kills)
    )
    return Row(
        f"a run killed with SIGKILL continues from its last checkpoint and ends with the same bits: {name}",
        f"{len(kills)} kills; checkpoints they left: {times}; {end}; result, CSV and summary "
        + ("are those of a run without kills, bit for bit" if same else "differ"),
        (
            RESUME + "test_a_run_killed_again_and_again_ends_as_one_that_was_not",
            "orchestrator/test_checkpoint.py::test_a_run_goes_on_from_any_macro_step_to_the_last_bit",
        ),
        command="tribocosim resume FOLDER",
        short="" if same else "not met.",
    )


def _diagnosis(out: Path) -> Row:
    changes = ("--set=stop_time=20 ms", "--set=reference.enabled=false", "--no-figures", "--out", str(out))
    tribocosim("run", "valve-train-controlled", *changes)
    done = tribocosim("diagnose", str(out))
    lines = [" ".join(line.split()) for line in done.output.splitlines() if line.strip()]
    return Row(
        "after the run: what limited each step (connection, estimator), histogram of steps and iterations, "
        "suggestions; as text and as a figure",
        f"{len(RULES)} rules for suggestions; the first 20 ms of valve-train-controlled: "
        f"“{' / '.join(lines[:7])}”",
        (
            DIAGNOSIS + "test_a_run_tells_in_its_summary_what_its_steps_were",
            DIAGNOSIS + "test_a_rule_speaks_with_ground_and_is_silent_without",
            DIAGNOSIS + "test_the_command_says_it_again_and_draws",
        ),
        command="tribocosim diagnose FOLDER --figure steps.png",
        short="" if done.status == 0 and lines else f"not met: {done}.",
    )


def _benchmark() -> Row:
    here = {peer: bool(importlib.util.find_spec(module)) for peer, module in PEERS.items()}
    return Row(
        "`tribocosim benchmark coupling`: error against doStep calls and wall time for all masters and the "
        "peers "
        "that are installed, on the same FMUs",
        f"{len(PROBLEMS)} problems ({', '.join(PROBLEMS)}), {len(METHODS)} masters and signals; peers: "
        + ", ".join(f"{peer} {'installed' if yes else 'not installed'}" for peer, yes in here.items()),
        (
            PRECISION + "test_peers_give_the_numbers_of_our_held_jacobi_at_the_same_times",
            PRECISION + "test_the_slope_of_a_line_is_the_order_of_its_signals",
            PRECISION + "test_the_benchmark_leaves_a_table_and_a_figure",
        ),
        command="tribocosim benchmark coupling --problem quarter-car",
        short="not run by this script (minutes); docs/coupling.md has a table of one run.",
    )
