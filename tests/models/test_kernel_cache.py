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

def made(factor):
    @kernel
    def inner(x):
        return factor * x
    return inner

def outer(function):
    @kernel
    def applied(x):
        return function(function(x))
    return applied

def symbols(*functions):
    return {c.fndesc.mangled_name for f in functions for c in f.overloads.values()}
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
def test_closures_from_the_cache_and_from_this_process_keep_apart(tmp_path):
    """Symbols are numbered per process: the same number must not make two closures one."""
    (tmp_path / "factory.py").write_text(FACTORY)
    first = "from factory import *; print(outer(made(3.0))(1.0))"
    assert float(run(tmp_path, first)) == 9.0
    stored = sorted((tmp_path / "cache").rglob("*.nbc"))
    assert float(run(tmp_path, first)) == 9.0
    assert sorted((tmp_path / "cache").rglob("*.nbc")) == stored, "the second process compiled again"
    # What is loaded bears the first process's numbers; what is compiled then begins to count anew.
    both = "from factory import *; a, b = outer(made(3.0)), outer(made(7.0)); print(a(1.0), b(1.0))"
    assert run(tmp_path, both).split() == ["9.0", "49.0"]
    assert run(tmp_path, f"{both}; print(len(symbols(a, b)))").split()[-1] == "2"
