"""Without compilation the kernels are the same functions."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from models.catalogue import CATALOGUE
from models.compile.kernel import COMPILED

from .plain_run import FEW, evaluated


@pytest.mark.skipif(not COMPILED, reason="compares compiled with plain code")
@pytest.mark.parametrize("names", [FEW, pytest.param(tuple(CATALOGUE), marks=pytest.mark.long)])
def test_plain_python_equals_compiled_code(names):
    done = subprocess.run(
        [sys.executable, "-m", "tests.models.plain_run", *names],
        cwd=Path(__file__).parents[2],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    plain = json.loads(done.stdout)
    assert plain["compiled"] is False
    compiled = evaluated(names)
    assert plain["values"].keys() == compiled.keys()
    for name, values in compiled.items():
        # Elementary functions of both may differ in the last digit; sums of ten terms grow that.
        assert plain["values"][name] == pytest.approx(values, rel=1e-13, abs=1e-13, nan_ok=True), name
