"""What checkpoints cost a coupled run that records every macro step: most has to reach the disk then."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from unittest import mock

import numpy as np
from rich.console import Console

from fmus.build import build
from orchestrator.reporter import Reporter
from orchestrator.run import execute as coupled_run
from orchestrator.run.checkpoint import Checkpoints
from orchestrator.run.pipeline import run
from orchestrator.scenario.files import load

EVERY = 10.0  # s
LENGTH = 0.04  # s, of 1e-7 s steps


class Timed(Checkpoints):
    """Notes how long each takes, and the file's size."""

    seconds: list[float]
    size: int

    def _write(self) -> None:
        began = time.perf_counter()
        super()._write()
        Timed.seconds.append(time.perf_counter() - began)
        Timed.size = self._path.stat().st_size


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
    overrides = ["macro_step=1e-7", "output_step=1e-7", f"stop_time={LENGTH}", "reference.enabled=false"]
    loaded = load("valve-train", [*overrides, f"checkpoint_every={EVERY}"])
    Timed.seconds = []
    with tempfile.TemporaryDirectory() as folder, mock.patch.object(coupled_run, "Checkpoints", Timed):
        summary = run(
            loaded, Path(folder), lambda name, structure, kind: build(name, structure=structure),
            Reporter(Console(quiet=True)), figures=False,
        )  # fmt: skip
    # Without those of the start and the end, where there is less to write.
    usual = 1e3 * np.array(Timed.seconds[1:-1])
    speed = summary.macro_steps / summary.coupled_time_s
    what = f"checkpoint: valve-train, {speed:.0f} recorded steps/s"
    each = f"{np.median(usual):.1f} ms (largest {usual.max():.1f} ms, {usual.size} of them)"
    share = 100.0 * sum(Timed.seconds) / summary.coupled_time_s
    return [
        (f"{what}, one each {EVERY:g} s", f"{each}, {Timed.size / 1e3:.1f} kB"),
        (f"{what}: share of the wall time, all checkpoints", f"{share:.2f} %"),
    ]
