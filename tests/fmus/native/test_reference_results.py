"""Native FMUs reproduce the reference results that they ship: their own steps, and a host that integrates."""

from pathlib import Path

import pytest

from fmus.reference_results.compare import CO_SIMULATION, MODEL_EXCHANGE, Comparison, compare

from .names import EVERY


@pytest.mark.parametrize("name", EVERY)
def test_fmi2(name: str, referenced_native_files: dict[str, Path], record) -> None:
    record_deviations(record, "FMI 2", agrees(referenced_native_files[name]))


@pytest.mark.long
@pytest.mark.parametrize("name", EVERY)
def test_fmi3(name: str, referenced_fmi3_files: dict[str, Path]) -> None:
    agrees(referenced_fmi3_files[name])


@pytest.mark.long
def test_fmi3_with_impacts(referenced_fmi3_files: dict[str, Path], record) -> None:
    record_deviations(record, "FMI 3, slider_crank", agrees(referenced_fmi3_files["slider_crank"]))


def agrees(path: Path) -> list[Comparison]:
    """Both ways, each within the tolerance that it ships with."""
    found = compare(path)
    assert [comparison.kind for comparison in found] == [CO_SIMULATION, MODEL_EXCHANGE]
    for comparison in found:
        assert comparison.agrees, str(comparison)
    return found


def record_deviations(record, version: str, found: list[Comparison]) -> None:
    for comparison in found:
        quantity, worst = f"deviation of native FMUs, {version}, {comparison.kind}", comparison.worst.relative
        source = "reference results in the FMU"
        record("FMUs", quantity, worst, 0.0, source, tolerance=comparison.tolerance)
