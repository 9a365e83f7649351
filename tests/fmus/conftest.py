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

from .kinds import FILES, WITH_REFERENCES, Made, made_files

INSTANCE = Path(__file__).with_name("instance.py")


@pytest.fixture(scope="session")
def fmu_files() -> Made:
    """Every FMU in Python as a file."""
    return FILES["python"]


@pytest.fixture(scope="session")
def native_files() -> Made:
    """Every native FMU of FMI 2.0 for this machine."""
    return FILES["native"]


@pytest.fixture(scope="session")
def fmi3_files() -> Made:
    """Those of FMI 3.0."""
    return FILES["native3"]


@pytest.fixture(scope="session")
def referenced() -> Made:
    """Every FMU in Python with its reference results."""
    return WITH_REFERENCES["python"]


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
