"""The packaged files, built once, and a way to run code where the repository cannot be imported."""

import json
import os
import subprocess
import sys
import textwrap
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from fmus.build import build
from tests.shared import made_once

INSTANCE = Path(__file__).with_name("instance.py")


class Made(dict[str, Path]):
    """Files or folders by name, each made when it is first asked for."""

    def __init__(self, make: Callable[[str], Path]) -> None:
        super().__init__()
        self.make = make

    def __missing__(self, name: str) -> Path:
        self[name] = self.make(name)
        return self[name]


def made_files(kind: str, make: Callable[[str, Path], object]) -> Made:
    """Files that `make(name, folder)` leaves in a folder, each made once for all processes."""
    return Made(lambda name: next(made_once(f"{kind}-{name}", lambda f: make(name, f)).iterdir()))


@pytest.fixture(scope="session")
def fmu_files() -> Made:
    """Every FMU as a file."""
    return Made(build)


@pytest.fixture(scope="session")
def referenced() -> Made:
    """Every FMU with its reference results."""
    return made_files("referenced", build)


@pytest.fixture(scope="session")
def unpacked(fmu_files: Made) -> Made:
    """Every FMU as a folder."""

    def extract(name: str, folder: Path) -> None:
        with zipfile.ZipFile(fmu_files[name]) as archive:
            archive.extractall(folder / name)

    return made_files("unpacked", extract)


Isolated = Callable[..., Any]


@pytest.fixture
def isolated(tmp_path: Path) -> Isolated:
    """isolated(code, *blocked, **environment): what the code reports, run in a fresh interpreter.

    The interpreter starts in an empty folder, ignores PYTHONPATH, and cannot import this repository.
    """

    def run(code: str, *blocked: str, **environment: str) -> Any:
        finished = subprocess.run(
            [sys.executable, "-I", str(INSTANCE), textwrap.dedent(code), *blocked],
            cwd=tmp_path,
            env=clean_environment(environment),
            capture_output=True,
            text=True,
            timeout=600,  # of a call that hangs; on a busy machine compiling takes minutes
            check=False,
        )
        assert finished.returncode == 0, finished.stdout + finished.stderr
        lines = [line for line in finished.stdout.splitlines() if line.startswith("REPORT ")]
        assert lines, finished.stdout + finished.stderr
        return json.loads(lines[-1].removeprefix("REPORT "))

    return run


def clean_environment(added: Mapping[str, str]) -> dict[str, str]:
    """This process's environment without Python's variables."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    return kept | dict(added)
