"""Compiled kernels kept on disk: reused by other processes, never one closure for another."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from models.kernel import COMPILED

ROOT = Path(__file__).parent.parent.parent

FACTORY = """
from models.kernel import kernel

def scaled_by(factor):
    @kernel
    def scaled(x):
        return factor * x
    return scaled

def twice(function):
    @kernel
    def applied(x):
        return function(function(x))
    return applied
"""


def run(folder: Path, code: str) -> str:
    """What `code` prints in a fresh process that shares this test's cache."""
    environment = dict(
        os.environ,
        TRIBOCOSIM_CACHE=str(folder / "cache"),
        PYTHONPATH=os.pathsep.join([str(ROOT), str(folder)]),
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, cwd=folder, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.skipif(not COMPILED, reason="there is nothing to keep without numba")
def test_closures_compiled_in_different_processes_keep_apart_in_a_third(tmp_path):
    """Symbols are numbered per process: the same number must not make two closures one."""
    (tmp_path / "factory.py").write_text(FACTORY)
    call = "from factory import *; print(twice(scaled_by({0}))(1.0))"
    assert float(run(tmp_path, call.format("3.0"))) == 9.0
    assert float(run(tmp_path, call.format("5.0"))) == 25.0
    stored = sorted((tmp_path / "cache").rglob("*.nbc"))
    both = "from factory import *; print(twice(scaled_by(3.0))(1.0), twice(scaled_by(5.0))(1.0))"
    assert run(tmp_path, both).split() == ["9.0", "25.0"]
    assert sorted((tmp_path / "cache").rglob("*.nbc")) == stored, "the third process compiled again"
