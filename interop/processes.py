"""Starts each tool in its own process and environment."""

import importlib
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import venv
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

from models.compile.cache_folder import user_cache_directory

from . import tools
from .case import FOLDER, Case

ROOT = Path(__file__).parents[1]
NAMES: tuple[str, ...] = tuple(sorted(file.stem for file in Path(tools.__file__).parent.glob("[a-z]*.py")))

# Needed by FMUs in Python, for steps at compiled speed.
FOR_FMUS = ("numpy", "numba")
# s, for calls that hang. With the first program for a platform zig compiles its C library: that takes
# minutes, and on a busy machine ten times as long.
TIME_LIMIT = 1800.0


@cache
def load_tool(name: str) -> ModuleType:
    """Import the tool's file."""
    return importlib.import_module(f"interop.tools.{name}")


@dataclass(frozen=True)
class Answer:
    """A tool's result for a case. `failed`: why it stopped early or was not tried; else empty."""

    version: str = ""
    loaded: bool = False
    values: list[list[float]] | None = None
    failed: str = ""
    tried: bool = True


def environment_folder(name: str) -> Path:
    """Folder of the tool's own environment; it may be missing."""
    return user_cache_directory() / "tools" / name


def find_interpreter(name: str) -> Path:
    """The interpreter of the tool's environment, or this process's if it has none."""
    folder = environment_folder(name)
    for place in ("bin/python", "Scripts/python.exe"):
        if (folder / place).exists():
            return folder / place
    return Path(sys.executable)


def install(name: str) -> bool:
    """Install the tool's packages in their own environment; False if pip fails."""
    folder = environment_folder(name)
    venv.create(folder, with_pip=True, clear=True)
    packages = [*load_tool(name).REQUIREMENTS, *FOR_FMUS]
    command = [str(find_interpreter(name)), "-m", "pip", "install", "--quiet", *packages]
    return subprocess.run(command, check=False).returncode == 0


@cache
def explain_missing(name: str, python: Path | None = None) -> str:
    """Why this interpreter, by default the tool's own, cannot run the tool; empty if it can."""
    why = ask(name, python=python).failed
    return f"{load_tool(name).TITLE} cannot run here: {why}" if why else ""


def ask(name: str, case: Case | None = None, python: Path | None = None) -> Answer:
    """Run the tool on a case, or, ask for its version only."""
    with tempfile.TemporaryDirectory(prefix="tribocosim-tools-") as folder:
        command = [str(python or find_interpreter(name)), "-m", "interop.tool_process", name]
        if case is not None:
            command += [str(case.write(Path(folder) / "case.json"))]
        environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        with subprocess.Popen(
            command,
            cwd=folder,
            env=environment
            | {"PYTHONPATH": str(ROOT), "TMPDIR": folder, FOLDER: str(environment_folder(name))},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
            start_new_session=True,
        ) as process:
            try:
                output = process.communicate(timeout=TIME_LIMIT)
            except BaseException as error:
                _end(process)
                if isinstance(error, subprocess.TimeoutExpired):
                    return Answer(failed=f"no answer in {TIME_LIMIT:g} s")
                raise  # an interruption, which the process in its own session does not get
    answer = _read_answer(subprocess.CompletedProcess(command, process.returncode, *output))
    known = answer.failed.replace(case.fmu, "the FMU") if case else answer.failed
    return replace(answer, failed=re.sub(r"(/[^\s/'\"]+)+/", "…/", known))


def _end(process: subprocess.Popen[str]) -> None:
    """With what it has started, as compilers and emulators, which would go on."""
    if hasattr(os, "killpg"):
        os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()
    process.wait()


def _read_answer(finished: subprocess.CompletedProcess[str]) -> Answer:
    reported: dict[str, Any] = {}
    for line in finished.stdout.splitlines():
        word, _, rest = line.partition(" ")
        if word in ("VERSION", "VALUES", "FAILED", "UNTRIED"):
            reported[word] = json.loads(rest)
        elif word == "LOADED":
            reported[word] = True
    failed = reported.get("FAILED", "") or reported.get("UNTRIED", "")
    if finished.returncode and not failed:
        failed = (
            _describe_exit(finished.returncode) + ": " + (finished.stderr.strip().splitlines() or [""])[-1]
        )
    return Answer(
        version=reported.get("VERSION", ""),
        loaded="LOADED" in reported,
        values=reported.get("VALUES"),
        failed=failed,
        tried="UNTRIED" not in reported,
    )


def _describe_exit(code: int) -> str:
    return f"ended by {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"
