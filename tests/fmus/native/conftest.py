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
