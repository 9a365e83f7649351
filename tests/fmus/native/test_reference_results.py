"""Native FMUs reproduce the reference results that they ship: their own steps, and a host that integrates."""

from __future__ import annotations

from pathlib import Path

import pytest
from fmpy.cross_check.validate_vendor_repo import validate_test_fmu

from fmus.cross_check.compare import CO_SIMULATION, MODEL_EXCHANGE, Comparison, compare
from fmus.cross_check.layout import lay_out

from .names import EVERY


@pytest.mark.parametrize("name", EVERY)
def test_fmi2(name: str, native_files: dict[str, Path], tmp_path: Path, record) -> None:
    record_deviations(record, "FMI 2", agrees(native_files[name]))
    check(name, native_files[name], tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("name", EVERY)
def test_fmi3(name: str, fmi3_files: dict[str, Path], tmp_path: Path) -> None:
    agrees(fmi3_files[name])
    check(name, fmi3_files[name], tmp_path)


@pytest.mark.long
def test_fmi3_with_impacts(fmi3_files: dict[str, Path], record) -> None:
    record_deviations(record, "FMI 3, slider_crank", agrees(fmi3_files["slider_crank"]))


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


def check(name: str, path: Path, out: Path) -> None:
    """The project's script finds nothing in the folders of either kind."""
    folders = list(lay_out(name, path, "tool", out))
    assert [folder.parts[-5] for folder in folders] == ["cs", "me"]
    for folder in folders:
        assert validate_test_fmu(str(folder)) == []
        (comparison,) = compare(folder / f"{name}.fmu")
        assert comparison.options.step_size == 0.0 or comparison.kind == CO_SIMULATION
        assert comparison.agrees
