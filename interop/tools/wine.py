"""The program in C for Windows, run by wine."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from ..c_program import Host, compile_host
from ..case import FOLDER, Case, NotTriedError, RefusedError

TITLE = "program in C for Windows, in wine"
REQUIREMENTS = ("fmpy", "ziglang")
USE = "Debian's wine64, or Windows"
PLATFORM = "x86_64-windows"
FINDINGS = (
    "Differences come from the system's C library, here wine's `ucrtbase.dll`. Its elementary functions "
    "differ from glibc's by up to three units in the last place, and rates amplify that.",
    "FMUs in Python need a Python for Windows.",
)


def version() -> str:
    if shutil.which("wine") is None:
        raise RefusedError("there is no wine (Debian's wine64)")
    return subprocess.run(["wine", "--version"], capture_output=True, text=True, check=True).stdout.strip()


def values(case: Case) -> list[list[float]]:
    if case.python:
        raise NotTriedError("there is no Python for Windows here")
    prefix = Path(os.environ[FOLDER]) / "prefix"
    prefix.parent.mkdir(parents=True, exist_ok=True)
    os.environ |= {"WINEPREFIX": str(prefix), "WINEDEBUG": "-all"}
    with tempfile.TemporaryDirectory() as folder:
        program = compile_host(Path(folder), "x86_64-windows-gnu", ".exe")
        return Host(program, {2: "win64", 3: PLATFORM}, ".dll", runner=["wine"], drive="Z:").values(case)
