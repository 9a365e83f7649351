"""The core on a CUDA device agrees with the processor to rounding, over the horizon that rounding allows."""

import os
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from models.slider_crank.motions import gpu
from models.slider_crank.motions.machine import Machine, Motion, exponents_of

# Chaotic, periodic, sliding.
CASES = [(0.05, 0.01), (0.05, 0.015), (0.25, 0.015), (0.025, 0.02)]
CYCLES = 4


def compare(form: str) -> None:
    """Four revolutions: rounding of 1e-16 grown by e^(0.42 * 25) = 4e4 stays below 1e-10."""
    machines = [Machine(damping, gap, form=form) for damping, gap in CASES]
    found = gpu.grow_tangents(machines, CYCLES, blocks=CYCLES)
    for machine, growths, impacts, state in zip(machines, *found[:3], strict=True):
        motion = Motion(machine)
        expected = motion.exponents(CYCLES, blocks=CYCLES)
        assert impacts == motion.impact_count
        assert state == pytest.approx(motion._position[2:4], abs=1e-10)
        exponents = exponents_of(machine, growths, float(impacts), found.length)
        if np.isfinite(expected.largest):
            assert exponents == pytest.approx(expected, abs=1e-10)
        else:
            assert not np.isfinite(exponents.largest)


@pytest.fixture(scope="module")
def _device() -> None:
    try:
        gpu.grow_tangents([Machine()], 1, blocks=1)
    except gpu.NoDeviceError as reason:
        pytest.skip(str(reason))


FORMS = pytest.mark.parametrize("form", ["as_published", pytest.param("nonlinear", marks=pytest.mark.long)])


@pytest.mark.usefixtures("_device")
@FORMS
def test_device_agrees_with_the_processor(form: str) -> None:
    compare(form)


@pytest.mark.usefixtures("_device")
def test_exponents_on_a_device_agree_within_their_uncertainty() -> None:
    found = gpu.compute_exponents([Machine(0.05, 0.01, form="as_published")], 4000, transient=50)[0]
    assert found.largest == pytest.approx(0.4116, abs=5.0 * found.uncertainty)


@pytest.mark.parametrize("unusable", ["module", "device"])
def test_missing_device_is_named(unusable: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With its remedy: without numba's CUDA, and with it but without a device."""

    def load(name: str, package: str) -> SimpleNamespace:
        if unusable == "module":
            raise ImportError("no libnvvm")
        return SimpleNamespace(cuda=SimpleNamespace(is_available=lambda: False))

    monkeypatch.setattr(gpu, "import_module", load)
    with pytest.raises(gpu.NoDeviceError, match=r"tribocosim\[cuda\]"):
        gpu.grow_tangents([Machine()], 1, blocks=1)


@FORMS
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
        gpu.grow_tangents([Machine(), Machine(form="nonlinear")], 1)
