"""The native FMUs for this machine, built once."""

from __future__ import annotations

import platform
import sys
from pathlib import Path

import pytest

from fmus.build import NAMES
from fmus.native.fmu import build

_SYSTEMS = {"linux": "linux", "win32": "windows", "darwin": "darwin"}
_PROCESSORS = {"AMD64": "x86_64", "arm64": "aarch64"}

HERE = f"{_PROCESSORS.get(platform.machine(), platform.machine())}-{_SYSTEMS.get(sys.platform, sys.platform)}"


@pytest.fixture(scope="session")
def native_files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Every native FMU as a file."""
    folder = tmp_path_factory.mktemp("native")
    return {name: build(name, folder, platforms=[HERE]) for name in NAMES}
