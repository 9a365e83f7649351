"""The native FMUs for this machine, each built once."""

from __future__ import annotations

import pytest

from fmus.native.fmu import build
from fmus.native.machine_code import this_platform

from ..conftest import Made


def _build_in(folders: pytest.TempPathFactory, fmi: int) -> Made:
    folder, here = folders.mktemp(f"fmi{fmi}"), [this_platform()]
    return Made(lambda name: build(name, folder, platforms=here, fmi=fmi))


@pytest.fixture(scope="session")
def native_files(tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Every native FMU of FMI 2.0 as a file."""
    return _build_in(tmp_path_factory, 2)


@pytest.fixture(scope="session")
def fmi3_files(tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Those of FMI 3.0."""
    return _build_in(tmp_path_factory, 3)
