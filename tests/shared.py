"""What takes long to make is made once for all processes of a run of the tests: FMUs, libraries, programs."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import locket
import pytest

_folder: list[Path] = []


@pytest.fixture(scope="session", autouse=True)
def shared_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of all processes: pytest-xdist gives each of its own one inside of it."""
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "shared"
    folder.mkdir(exist_ok=True)
    _folder[:] = [folder]
    return folder


def made_once(name: str, make: Callable[[Path], object]) -> Path:
    """The folder of this name, filled by `make(folder)` in the process that first asks for it."""
    (folder,) = _folder
    made = folder / name
    with locket.lock_file(f"{made}.lock"):
        if not made.exists():
            shutil.rmtree(partial := folder / f"{name}.partial", ignore_errors=True)
            partial.mkdir()
            make(partial)
            partial.rename(made)
    return made
