"""The native FMUs for this machine, built once."""

from __future__ import annotations

from pathlib import Path

import pytest

from fmus.build import NAMES
from fmus.native.fmu import build
from fmus.native.machine_code import this_platform


@pytest.fixture(scope="session")
def native_files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Every native FMU as a file."""
    folder = tmp_path_factory.mktemp("native")
    return {name: build(name, folder, platforms=[this_platform()]) for name in NAMES}


class Fmi3Files(dict[str, Path]):
    """Native FMUs of FMI 3.0 as files, built when they are asked for."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __missing__(self, name: str) -> Path:
        self[name] = build(name, self.folder, platforms=[this_platform()], fmi=3)
        return self[name]


@pytest.fixture(scope="session")
def fmi3_files(tmp_path_factory: pytest.TempPathFactory) -> Fmi3Files:
    return Fmi3Files(tmp_path_factory.mktemp("fmi3"))
