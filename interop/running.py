"""Runs tools in processes of their own, in their own environments where they have one."""

from __future__ import annotations

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

from models.cache_folder import user_cache_directory

from . import hosts
from .case import FOLDER, Case

ROOT = Path(__file__).parents[1]
NAMES: tuple[str, ...] = tuple(sorted(file.stem for file in Path(hosts.__file__).parent.glob("[a-z]*.py")))

# What FMUs need that run in Python, with steps at compiled speed.
FOR_FMUS = ("numpy", "numba")
PATIENCE = 600.0  # s, for a call that hangs; compiling takes minutes on a busy machine


@cache
def host(name: str) -> ModuleType:
    """The tool's file."""
    return importlib.import_module(f"interop.hosts.{name}")


@dataclass(frozen=True)
class Answer:
    """What a tool made of a case: `failed` is why it ended early, or was not tried, or empty."""

    version: str = ""
    loaded: bool = False
    values: list[list[float]] | None = None
    rate: float | None = None
    failed: str = ""
    tried: bool = True


def environment(name: str) -> Path:
    """The folder of the tool's own environment, which need not be there."""
    return user_cache_directory() / "tools" / name


def interpreter(name: str) -> Path:
    """That of the tool's own environment if it has one, else that of this process."""
    folder = environment(name)
    for place in ("bin/python", "Scripts/python.exe"):
        if (folder / place).exists():
            return folder / place
    return Path(sys.executable)


def install(name: str) -> bool:
    """The tool's packages, in an environment of their own; False if pip cannot, which says why itself."""
    folder = environment(name)
    venv.create(folder, with_pip=True, clear=True)
    packages = [*host(name).REQUIREMENTS, *FOR_FMUS]
    command = [str(interpreter(name)), "-m", "pip", "install", "--quiet", *packages]
    return subprocess.run(command, check=False).returncode == 0


@cache
def missing(name: str, python: Path | None = None) -> str:
    """Why the tool cannot be run by its interpreter, or by this one; or nothing."""
    why = ask(name, python=python).failed
    return f"{host(name).TITLE} cannot run here: {why}" if why else ""


def ask(name: str, case: Case | None = None, runs: int = 0, python: Path | None = None) -> Answer:
    """The tool's answer to a case, its rate of so many runs; without a case, only its version."""
    with tempfile.TemporaryDirectory(prefix="tribocosim-tools-") as folder:
        command = [str(python or interpreter(name)), "-m", "interop.inside", name]
        if case is not None:
            command += [str(case.written(Path(folder) / "case.json")), str(runs)]
        kept = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        try:
            finished = subprocess.run(
                command,
                cwd=folder,
                env=kept | {"PYTHONPATH": str(ROOT), "TMPDIR": folder, FOLDER: str(environment(name))},
                capture_output=True,
                text=True,
                errors="replace",
                timeout=PATIENCE,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return Answer(failed=f"no answer in {PATIENCE:g} s")
    answer = _answer(finished)
    known = answer.failed.replace(case.fmu, "the FMU") if case else answer.failed
    return replace(answer, failed=re.sub(r"(/[^\s/'\"]+)+/", "…/", known))


def _answer(finished: subprocess.CompletedProcess[str]) -> Answer:
    told: dict[str, Any] = {}
    for line in finished.stdout.splitlines():
        word, _, rest = line.partition(" ")
        if word in ("VERSION", "VALUES", "RATE", "FAILED", "UNTRIED"):
            told[word] = json.loads(rest)
        elif word == "LOADED":
            told[word] = True
    failed = told.get("FAILED", "") or told.get("UNTRIED", "")
    if finished.returncode and not failed:
        failed = _ending(finished.returncode) + ": " + (finished.stderr.strip().splitlines() or [""])[-1]
    return Answer(
        version=told.get("VERSION", ""),
        loaded="LOADED" in told,
        values=told.get("VALUES"),
        rate=told.get("RATE"),
        failed=failed,
        tried="UNTRIED" not in told,
    )


def _ending(code: int) -> str:
    return f"ended by {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"
