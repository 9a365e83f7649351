"""A native FMU gives the numbers of the component to the last bit, where both use the same libm."""

from pathlib import Path

import pytest

from ..conftest import Isolated
from ..reference import Reference, schedule
from ..test_agreement import STEP, STEPS, expected_of, replay
from .names import EVERY


@pytest.mark.parametrize("name", EVERY)
def test_native_fmu_equals_component(
    name: str, native_files: dict[str, Path], isolated: Isolated, tmp_path: Path, record
) -> None:
    """Outputs, their rates and energies; also between steps, and with steps of changing size."""
    reference = Reference(name)
    plan = schedule(reference.component, STEPS, STEP)
    found, expected = replay(isolated, native_files[name], plan, tmp_path), expected_of(reference, plan)
    quantity = "outputs, rates and energies of native FMUs"
    record("FMUs", quantity, found, expected, "component in process", tolerance=0)
