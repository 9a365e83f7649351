"""Processor time of the whole warm command `run valve-train`, beside its stepping alone and its reference.

The command runs in a process of its own, with everything compiled; its child processes are included.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable

import numpy as np

from models.core.system import System
from models.monolithic import solve

from .loops import run_master
from .measure import load_system, measure_medians
from .native import NATIVE, PYTHON, list_files

# As for a user, whose Python keeps bytecode.
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
COMMAND = "import sys; from tribocosim.command_line import main; sys.exit(main())"
ROUNDS = 3


def run_command(*options: str) -> float:
    """Processor time (s) of `run valve-train` with these options."""
    before = os.times()
    with tempfile.TemporaryDirectory() as folder:
        arguments = ["run", "valve-train", "--out", os.path.join(folder, "run"), *options]
        command = [sys.executable, "-c", COMMAND, *arguments]
        subprocess.run(command, check=True, capture_output=True, env=ENVIRONMENT)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


def solve_reference(system: System, times: np.ndarray) -> float:
    """Processor time (s) of the monolithic reference."""
    began = time.process_time()
    solve(system, times)
    return time.process_time() - began


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
    scenario, system = load_system("valve-train")
    paths = list_files(system)
    steps = round(scenario.stop_time / scenario.macro_step)
    times = np.linspace(0.0, scenario.stop_time, round(scenario.stop_time / scenario.output_step) + 1)
    reference = "monolithic reference"
    candidates: dict[str, Callable[[], float]] = {reference: lambda: solve_reference(system, times)}
    for kind, options in ((PYTHON, ()), (NATIVE, ("--native",))):
        candidates[f"stepping alone, FMUs {kind}"] = lambda kind=kind: (
            steps * run_master(system, scenario.build_master(), files=paths[kind])
        )
        candidates[f"run valve-train, FMUs {kind}"] = lambda options=options: run_command(*options)
    found = measure_medians(candidates, ROUNDS)
    base = found[f"stepping alone, FMUs {PYTHON}"] + found[reference]
    return [
        (f"whole command: {name}", f"{seconds:.2f} s ({seconds / base:.2f} x stepping and reference)")
        for name, seconds in found.items()
    ]
