"""The native FMUs for this machine, each built once."""

from __future__ import annotations

from pathlib import Path

import pytest

from fmus.native.fmu import build
from fmus.native.machine_code import this_platform


class Built(dict[str, Path]):
    """FMUs of a version of FMI by name, built in a folder when they are first asked for."""

    def __init__(self, folder: Path, fmi: int) -> None:
        super().__init__()
        self.folder, self.fmi = folder, fmi

    def __missing__(self, name: str) -> Path:
        self[name] = build(name, self.folder, platforms=[this_platform()], fmi=self.fmi)
        return self[name]


@pytest.fixture(scope="session")
def native_files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Every native FMU of FMI 2.0 as a file."""
    return Built(tmp_path_factory.mktemp("native"), 2)


@pytest.fixture(scope="session")
def fmi3_files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Those of FMI 3.0."""
    return Built(tmp_path_factory.mktemp("fmi3"), 3)
