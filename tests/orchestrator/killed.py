"""Runs a scenario in child processes that are killed again and again, and resumes it until it ends.

`python -m tests.orchestrator.killed FOLDER SEED KILLS SCENARIO [PATH=VALUE ...]` prints where the kills came.
Children are forked, so that they need not import, and killed with SIGKILL: in turn a random time after they
have begun to step, as they make the n-th of the calls that checkpoints are made of, and a random time after
their start. Checkpoints are written without pause.
"""

import math
import os
import random
import signal
import sys
import time as clock
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console

from orchestrator.reporter import Reporter
from orchestrator.run import checkpoint
from orchestrator.run.pipeline import resume, run
from orchestrator.scenario.files import load
from orchestrator.store import atomic_write as replacement
from orchestrator.store import csv_file, journal
from orchestrator.store import result_file as results
from orchestrator.store.output_folder import CHECKPOINT, find_run_state
from tribocosim.cached_fmus import build_fmu

STEPPING, STARTING = 0.1, 0.4  # s, a part of what the runs take
EVERY = "checkpoint_every=1e-9"


def left(out: Path, calls: int, scenario: str, overrides: list[str]) -> None:
    """Run in this process, which is killed at that call. Every step writes a checkpoint."""
    checkpoint.SHARE = math.inf
    _die_at_call(calls)
    run(load(scenario, [*overrides, EVERY]), out, build_fmu, Reporter(Console(quiet=True)), figures=False)


def main(out: Path, seed: int, kills: int, scenario: str, overrides: list[str]) -> None:
    checkpoint.SHARE = 1.0
    draw = random.Random(seed)
    loaded = load(scenario, [*overrides, EVERY])
    quiet = Reporter(Console(quiet=True))
    for n in range(10 * kills):
        if not (out / "scenario.toml").exists():
            work: Callable[[], Any] = partial(
                run, loaded, out, build_fmu, quiet, overwrite=True, figures=False
            )
        else:
            work = partial(resume, out, build_fmu, quiet, figures=False)
        child = os.fork()
        if child == 0:
            if n < kills and n % 3 == 1:
                _die_at_call(draw.randrange(1, 40))
            summary = work()
            os._exit(0 if summary.complete else 1)
        if n < kills and n % 3 != 1:
            if n % 3 == 0:
                _wait_for_a_checkpoint(out, child)
            clock.sleep(draw.uniform(0.0, STEPPING if n % 3 == 0 else STARTING))
            os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
        if not os.WIFSIGNALED(status):
            print("ended with", os.waitstatus_to_exitcode(status), flush=True)
            return
        left = sorted(path.name for path in find_run_state(out).glob("*"))
        print("killed", _time(out), " ".join(left), flush=True)


def _wait_for_a_checkpoint(out: Path, child: int) -> None:
    """Until the child writes one, or has ended."""
    path = find_run_state(out) / CHECKPOINT

    def written() -> int:
        return path.stat().st_mtime_ns if path.exists() else 0

    before = written()
    while written() == before and not os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT):
        clock.sleep(1e-3)


class _Counted:
    """The module `os`, of which that call kills this process: a file handed to the disk, or put in
    another's place."""

    def __init__(self, calls: int) -> None:
        self._left = calls

    def __getattr__(self, name: str) -> Any:
        return getattr(os, name)

    def _count(self) -> None:
        self._left -= 1
        if self._left == 0:
            os.kill(os.getpid(), signal.SIGKILL)

    def fsync(self, file: int) -> None:
        self._count()
        os.fsync(file)

    def replace(self, new: Path, old: Path) -> None:
        self._count()
        os.replace(new, old)


def _die_at_call(number: int) -> None:
    """Of the calls of what writes runs; libraries make others."""
    counted: Any = _Counted(number)
    csv_file.os = journal.os = replacement.os = results.os = counted


def _time(out: Path) -> float:
    """How far the checkpoint is."""
    path = find_run_state(out) / CHECKPOINT
    return float(checkpoint.read(path)[1]["session"]["time"]) if path.exists() else -1.0


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4], sys.argv[5:])
