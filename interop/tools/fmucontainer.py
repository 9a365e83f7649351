"""FMUContainer: an FMU in C that has ours inside, run by FMPy."""

import shutil
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from ..case import Case, RefusedError
from . import fmpy

TITLE = "FMUContainer"
REQUIREMENTS = ("fmu-manipulation-toolbox", "fmpy")
USE = "nothing"
PROGRAM = Path(sys.executable).with_name("fmucontainer")


def version() -> str:
    from importlib.metadata import version

    if not PROGRAM.is_file():
        raise RefusedError("there is no command fmucontainer (package fmu-manipulation-toolbox)")
    return f"fmu-manipulation-toolbox {version('fmu-manipulation-toolbox')}, FMPy {fmpy.version()}"


def values(case: Case) -> list[list[float]]:
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(case.fmu, Path(folder) / "unit.fmu")
        (Path(folder) / "container.csv").write_text(
            "rule;from_fmu;from_port;to_fmu;to_port\nFMU;unit.fmu;;;\n"
        )
        command = [str(PROGRAM), "-container", f"container.csv:{case.step!r}", "-fmi", str(case.fmi)]
        finished = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if finished.returncode:
            raise RefusedError((finished.stdout + finished.stderr).strip().splitlines()[-1])
        return fmpy.values(replace(case, fmu=str(Path(folder) / "container.fmu")))
