"""Public FMUs and packages of other tools, which are not in the repository."""

import os
from pathlib import Path

import pytest

VARIABLE = "TRIBOCOSIM_THIRD_PARTY"
BESIDE = Path(__file__).parents[2].parent / "shared" / "third_party"


def public(name: str) -> Path:
    """The file of that name in the folder that the environment variable names, or beside the repository; the
    test is skipped where there is none."""
    for folder in (os.environ.get(VARIABLE), BESIDE):
        if folder and (path := Path(folder, name)).is_file():
            return path
    pytest.skip(f"needs {name}: set {VARIABLE} to a folder that has it")
