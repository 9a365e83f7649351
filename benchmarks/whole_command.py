"""Processor time of whole warm commands.

`run valve-train` beside its stepping alone and its reference, and a run of two small FMUs in processes of
their own. Each command runs in a process of its own, with everything compiled, and its child processes count.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from fmus.native.fmu import build as build_native
from fmus.native.machine_code import this_platform
from models.core.system import System
from models.monolithic import solve

from .loops import run_master
from .measure import load_system, measure_medians
from .native import NATIVE, PYTHON, list_files

# As for a user, whose Python keeps bytecode.
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
ROUNDS = 3


# Two masses on springs, as FMUs of which nothing but their description is known, with 1000 steps.
SMALL = """
stop_time = "1 s"
macro_step = "1 ms"
start = "given"
connections = [
    "first.force -> second.force",
    "second.position -> first.other_position",
    "second.velocity -> first.other_velocity",
]
tolerance = {{ "second.position" = 1e-3 }}
reference.method = "refinement"
[components.first]
participant = '{coupled_mass}'
process = "own"
[components.second]
participant = '{sprung_mass}'
process = "own"
parameters = {{ position_start = "1 m" }}
"""


def run_command(scenario: str, *options: str) -> float:
    """Processor time (s) of a run with these options."""
    before = os.times()
    with tempfile.TemporaryDirectory() as folder:
        arguments = ["run", scenario, "--out", os.path.join(folder, "run"), *options]
        command = [sys.executable, "-m", "tribocosim", *arguments]
        subprocess.run(command, check=True, capture_output=True, env=ENVIRONMENT)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


def measure_small(folder: Path) -> Iterator[tuple[str, str]]:
    """Of the run of two small FMUs."""
    files = {
        name: build_native(name, platforms=[this_platform()]) for name in ("coupled_mass", "sprung_mass")
    }
    (scenario := folder / "two.toml").write_text(SMALL.format(**files), "utf-8")
    candidates = {
        "two small FMUs": lambda: run_command(str(scenario), "--set", "reference.enabled=false"),
        "two small FMUs with reference": lambda: run_command(str(scenario)),
    }
    for name, seconds in measure_medians(candidates, ROUNDS).items():
        yield f"whole command: {name}, 1000 steps", f"{seconds:.2f} s"


def solve_reference(system: System, times: np.ndarray) -> float:
    """Processor time (s) of the monolithic reference."""
    began = time.process_time()
    solve(system, times)
    return time.process_time() - began


def measure() -> Iterator[tuple[str, str]]:
    """Figures and their values."""
    with tempfile.TemporaryDirectory() as folder:
        yield from measure_small(Path(folder))
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
        candidates[f"run valve-train, FMUs {kind}"] = lambda options=options: run_command(
            "valve-train", *options
        )
    found = measure_medians(candidates, ROUNDS)
    base = found[f"stepping alone, FMUs {PYTHON}"] + found[reference]
    for name, seconds in found.items():
        yield f"whole command: {name}", f"{seconds:.2f} s ({seconds / base:.2f} x stepping and reference)"
