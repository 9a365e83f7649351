"""Kernels in LLVM's language: they depend on their sources only."""

import os
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.long
def test_kernels_do_not_depend_on_what_was_compiled_before(tmp_path: Path) -> None:
    """With an empty cache and with the one that this fills."""
    environment = os.environ | {"TRIBOCOSIM_CACHE": str(tmp_path / "cache"), "XDG_CACHE_HOME": str(tmp_path)}
    command = [sys.executable, "-m", "fmus.native.translate", "flywheel"]
    cold, warm = (
        subprocess.run(command, env=environment, capture_output=True, check=True, text=True).stdout
        for _ in range(2)
    )
    assert "kernel_" in cold
    assert cold == warm
