"""Processor time of fresh processes and their children: imports, starts of FMUs, whole commands.

Commands are warm, with everything compiled, as the second one of a user; starts of FMUs and one command
also cold.
"""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fmus.build import build
from fmus.native.fmu import build as build_native
from fmus.native.machine_code import this_platform
from models.core.system import System
from models.monolithic import solve

from .measure import load_system, measure_medians
from .stepping import NATIVE, PYTHON, list_files, run_master

ROUNDS = 3
STARTS = {
    "bare interpreter": ("-c", "pass"),
    "import of fmpy": ("-c", "import fmpy"),
    "import of all component models": ("-c", "import models.catalogue"),
    "import of the master": ("-c", "import orchestrator.run.simulation"),
    "tribocosim --help": ("-m", "tribocosim", "--help"),
}
LOAD = """
import sys
from fmpy import simulate_fmu
simulate_fmu(sys.argv[1], stop_time=1e-4, step_size=1e-5, output_interval=1e-5)
"""
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


def run_python(*arguments: str, **environment: str) -> float:
    """Processor time (s) of a fresh interpreter, as a user's, which keeps bytecode."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    before = os.times()
    subprocess.run([sys.executable, *arguments], check=True, capture_output=True, env=kept | environment)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


def run_command(scenario: str, *options: str, **environment: str) -> float:
    """Processor time (s) of a run with these options."""
    with TemporaryDirectory() as folder:
        command = "-m", "tribocosim", "run", scenario, "--out", f"{folder}/run"
        return run_python(*command, *options, **environment)


def solve_reference(system: System, times: np.ndarray) -> float:
    """Processor time (s) of the monolithic reference."""
    began = time.process_time()
    solve(system, times)
    return time.process_time() - began


def measure() -> Iterator[tuple[str, str]]:
    """Figures and their values."""
    for name, seconds in measure_medians({n: partial(run_python, *a) for n, a in STARTS.items()}).items():
        yield f"start: {name}", f"{seconds:.2f} s"
    here = [this_platform()]
    with TemporaryDirectory() as folder:
        fmu = str(build("valve_spring", Path(folder), references=False))
        for name in ("first start (compiles)", "second start"):
            seconds = run_python("-c", LOAD, fmu, TRIBOCOSIM_CACHE=f"{folder}/cache")
            yield f"start: valve_spring.fmu, {name}", f"{seconds:.2f} s"
        files = {name: build_native(name, platforms=here) for name in ("coupled_mass", "sprung_mass")}
        (scenario := Path(folder) / "two.toml").write_text(SMALL.format(**files), "utf-8")
        options = {"": ("--set", "reference.enabled=false"), " with reference": ()}
        small = {name: partial(run_command, str(scenario), *given) for name, given in options.items()}
        for name, seconds in measure_medians(small, ROUNDS).items():
            yield f"whole command: two small FMUs{name}, 1000 steps", f"{seconds:.2f} s"
    plan, system = load_system("valve-train")
    steps = round(plan.stop_time / plan.macro_step)
    times = np.linspace(0.0, plan.stop_time, round(plan.stop_time / plan.output_step) + 1)
    found = measure_medians(
        {
            "monolithic reference": partial(solve_reference, system, times),
            **{
                f"stepping alone, FMUs {kind}": partial(_step, system, files, steps)
                for kind, files in list_files(system).items()
            },
            f"run valve-train, FMUs {PYTHON}": partial(run_command, "valve-train"),
            f"run valve-train, FMUs {NATIVE}": partial(run_command, "valve-train", "--native"),
        },
        ROUNDS,
    )
    base = found[f"stepping alone, FMUs {PYTHON}"] + found["monolithic reference"]
    for name, seconds in found.items():
        yield f"whole command: {name}", f"{seconds:.2f} s ({seconds / base:.2f} x stepping and reference)"

    with TemporaryDirectory() as folder:
        kernels = f"{folder}/empty/kernels"  # as a wheel with compiled kernels has them
        for name, shipped in {"empty": "", "empty, kernels of a wheel": kernels}.items():
            environment = {"TRIBOCOSIM_CACHE": f"{folder}/{name}", "TRIBOCOSIM_KERNELS": shipped}
            seconds = run_command("valve-train", **environment)
            yield f"whole command: run valve-train, cache {name}", f"{seconds:.2f} s"


def _step(system: System, files: dict[str, Path], steps: int) -> float:
    """Seconds that the scenario's steps take."""
    master = load_system("valve-train")[0].build_master()
    return steps / run_master(system, files, master)
