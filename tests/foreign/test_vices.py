"""An FMU from elsewhere that fails is named, and what was recorded before is kept, whatever it does."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from orchestrator.participants.fmu import Given
from orchestrator.participants.in_own_process import InOwnProcess
from orchestrator.report import Reporter
from orchestrator.run import run

from .c_fmus import fmu
from .runs import never, ran, scenario

GONE = r"decay: its process ended {} in the step from t = 0.5 s by 0.01 s; look at"
VICES = {
    "crashing": GONE.format("by SIGSEGV"),
    "aborting": GONE.format("by SIGABRT"),
    "leaving": GONE.format("with exit status 7"),
    "discarding": r"decay: step from t = 0.5 s .* returned Discard: no way on",
    "erring": r"decay: step from t = 0.5 s .* returned Error: out of range",
    "fatal": r"decay: step from t = 0.5 s .* returned Fatal: memory is gone",
    "ending": r"decay: the FMU asks to end the simulation at t = 0.5 s: has landed; set stop_time to that",
}


def case(path: Path, process: str, **changes: object):
    tables = {"decay": {"participant": path, "process": process}}
    return scenario(tables, master={"name": "jacobi"}, **changes)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("vice", VICES)
def test_the_run_ends_with_what_it_has(vice: str, version: int, tmp_path: Path) -> None:
    """Crashes only in a process of their own; everything else there and here."""
    path = fmu(vice, version, tmp_path)
    for process in ("own",) if vice in ("crashing", "aborting", "leaving") else ("own", "shared"):
        summary, found = ran(case(path, process), tmp_path / process)
        assert summary.exit_status == 3
        assert not summary.complete
        assert re.search(VICES[vice], summary.message), summary.message
        assert len(found["time"]) == 51
        assert found["time"][-1] == pytest.approx(0.5)


def test_one_that_crashes_before_the_start_is_named(tmp_path: Path) -> None:
    path = fmu("blind", 2, tmp_path)
    summary = run(case(path, "own"), tmp_path / "out", never, Reporter(), figures=False)
    assert summary.exit_status == 3
    assert "decay: its process ended by SIGSEGV in the call read_all" in summary.message


@pytest.mark.skipif(not hasattr(os, "fork"), reason="call_time_limit needs a POSIX system")
def test_one_that_hangs_is_ended(tmp_path: Path) -> None:
    # The limit holds for the start of its process as well.
    path = fmu("hanging", 3, tmp_path)
    summary, found = ran(case(path, "own", call_time_limit=5.0), tmp_path / "out")
    assert summary.exit_status == 3
    assert "decay: the step did not return within 5 s after t = 0.5 s" in summary.message
    assert len(found["time"]) == 51


def test_no_process_is_left(tmp_path: Path) -> None:
    """Neither of a run that ended well nor of one whose FMU crashed."""
    import psutil

    before = set(psutil.Process().children(recursive=True))
    ran(case(fmu("dahlquist", 2, tmp_path), "own"), tmp_path / "well")
    ran(case(fmu("crashing", 2, tmp_path), "own"), tmp_path / "badly")
    assert set(psutil.Process().children(recursive=True)) == before


def test_a_process_ends_when_it_is_told(tmp_path: Path) -> None:
    """By itself, and so with its own status: nobody has to wait and end it."""
    unit = InOwnProcess("decay", fmu("dahlquist", 2, tmp_path), Given(["x"], {}))
    process = unit._process
    unit.close()
    assert process.returncode == 0
