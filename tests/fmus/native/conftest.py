"""The native FMUs for this machine, each built once."""

from pathlib import Path

import pytest

from fmus.native.fmu import build
from fmus.native.machine_code import this_platform

from ..conftest import Made, made_files


def _build(name: str, folder: Path | None, fmi: int) -> Path:
    return build(name, folder, platforms=[this_platform()], fmi=fmi)


@pytest.fixture(scope="session")
def native_files() -> Made:
    """Every native FMU of FMI 2.0 as a file."""
    return Made(lambda name: _build(name, None, 2))


@pytest.fixture(scope="session")
def fmi3_files() -> Made:
    """Those of FMI 3.0."""
    return Made(lambda name: _build(name, None, 3))


@pytest.fixture(scope="session")
def referenced_native_files() -> Made:
    """Those of FMI 2.0 with their reference results."""
    return made_files("referenced2", lambda name, folder: _build(name, folder, 2))


@pytest.fixture(scope="session")
def referenced_fmi3_files() -> Made:
    """Those of FMI 3.0 with their reference results."""
    return made_files("referenced3", lambda name, folder: _build(name, folder, 3))
