"""The native FMUs for this machine, each built once."""

from __future__ import annotations

from pathlib import Path

import pytest

from fmus.native.fmu import build
from fmus.native.machine_code import this_platform

from ..conftest import Made


def _build(fmi: int, folder: Path | None = None) -> Made:
    return Made(lambda name: build(name, folder, platforms=[this_platform()], fmi=fmi))


@pytest.fixture(scope="session")
def native_files() -> Made:
    """Every native FMU of FMI 2.0 as a file."""
    return _build(2)


@pytest.fixture(scope="session")
def fmi3_files() -> Made:
    """Those of FMI 3.0."""
    return _build(3)


@pytest.fixture(scope="session")
def referenced_native_files(tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Those of FMI 2.0 with their reference results."""
    return _build(2, tmp_path_factory.mktemp("fmi2"))


@pytest.fixture(scope="session")
def referenced_fmi3_files(tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Those of FMI 3.0 with their reference results."""
    return _build(3, tmp_path_factory.mktemp("fmi3"))
