"""Import, build and start-up times, in fresh processes: cold (nothing compiled) and warm."""

import os
import subprocess
import sys
import tempfile
import time

LOAD = """
import sys
from pathlib import Path
from fmpy import simulate_fmu
simulate_fmu(sys.argv[1], stop_time=1e-4, step_size=1e-5, output_interval=1e-5)
"""


def measure_start(code: str, *arguments: str, cache: str | None = None) -> float:
    """Wall time of a fresh interpreter that runs `code`."""
    environment = dict(os.environ, **({"TRIBOCOSIM_CACHE": cache} if cache else {}))
    began = time.perf_counter()
    subprocess.run([sys.executable, "-c", code, *arguments], check=True, env=environment, capture_output=True)
    return time.perf_counter() - began


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
    found = [
        ("bare interpreter", measure_start("pass")),
        ("import of all component models", measure_start("import models.catalogue")),
        ("import of the master", measure_start("import orchestrator.run.simulation")),
        (
            "tribocosim --help",
            measure_start(
                "import sys; from tribocosim.command_line import main; sys.argv[1:] = ['--help']; main()"
            ),
        ),
    ]
    with tempfile.TemporaryDirectory() as cache:
        build = "from fmus.build import build, NAMES; [build(n) for n in NAMES]"
        found.append(("build of all FMUs", measure_start(build, cache=cache)))
        path = subprocess.run(
            [sys.executable, "-c", "from fmus.build import build; print(build('valve_spring'))"],
            check=True, capture_output=True, text=True, env=dict(os.environ, TRIBOCOSIM_CACHE=cache),
        ).stdout.strip()  # fmt: skip
        found.append(("valve_spring.fmu, first start (compiles)", measure_start(LOAD, path, cache=cache)))
        found.append(("valve_spring.fmu, second start", measure_start(LOAD, path, cache=cache)))
    found.append(("import of fmpy alone", measure_start("import fmpy")))
    return [(f"time: {name}", f"{time:.2f} s") for name, time in found]
