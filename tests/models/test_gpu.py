"""The core on a CUDA device agrees with the processor to rounding, over the horizon that rounding allows."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from models.slider_crank import gpu
from models.slider_crank.machine import Machine, Motion

# Chaotic, periodic, sliding.
CASES = [(0.05, 0.01), (0.05, 0.015), (0.25, 0.015), (0.025, 0.02)]
CYCLES = 4


def compare(form: str) -> None:
    """Four revolutions: rounding of 1e-16 grown by e^(0.42 * 25) = 4e4 stays below 1e-10."""
    machines = [Machine(damping, gap, form=form) for damping, gap in CASES]
    found = gpu.follow(machines, CYCLES)
    for i, machine in enumerate(machines):
        motion = Motion(machine)
        exponents = motion.exponents(CYCLES, blocks=CYCLES)
        assert found.impacts[i] == motion.impact_count
        if np.isfinite(exponents.largest):
            assert found.largest[i] == pytest.approx(exponents.largest, abs=1e-10)
            assert found.second[i] == pytest.approx(exponents.second, abs=1e-10)
        else:
            assert not np.isfinite(found.largest[i])
        assert found.state[i] == pytest.approx(motion._position[2:4], abs=1e-10)


@pytest.mark.parametrize("form", ["as_published", "nonlinear"])
def test_device_agrees_with_the_processor(form: str) -> None:
    try:
        compare(form)
    except gpu.NoDeviceError as reason:
        pytest.skip(str(reason))


@pytest.mark.parametrize("form", ["as_published", "nonlinear"])
def test_simulated_device_agrees_with_the_processor(form: str) -> None:
    """numba's simulator runs the device code without a device, in a process of its own."""
    code = f"from tests.models.test_gpu import compare; compare({form!r})"
    environment = {
        **os.environ,
        "NUMBA_ENABLE_CUDASIM": "1",
        "NUMBA_DISABLE_JIT": "1",
        "PYTHONPATH": os.pathsep.join(sys.path),
    }
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_forms_of_different_kinds_are_not_mixed() -> None:
    with pytest.raises(ValueError, match="one kind of form"):
        gpu.follow([Machine(), Machine(form="nonlinear")], 1)
