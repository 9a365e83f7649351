"""Values for third-party FMUs: numbers in the FMU's unit, items of enumerations, names of other tables."""

from pathlib import Path

import numpy as np
import pytest

from fmus.fmi.validate import info
from orchestrator.scenario.files import load
from orchestrator.scenario.warnings import list_warnings

from .c_fmus import fmu
from .described import describe2
from .models import MODELS, Model, V
from .runs import ran, scenario

VERSIONS = (2, 3)
TAKEN = "components.one.start.length = 0.002 mm: numbers without a unit are in the FMU's"
MILLIMETRES = [(0.002, 0.002, True), ("2 um", 0.002, False), ("0.002 m", 2.0, False)]


@pytest.mark.parametrize(
    ("version", "value", "millimetres", "named"),
    [(2 + i % 2, *case) for i, case in enumerate(MILLIMETRES)],
)
def test_a_number_without_a_unit_is_in_the_fmus_and_named(
    version: int, value: float | str, millimetres: float, named: bool, tmp_path: Path
) -> None:
    one = scenario({"one": {"participant": fmu("stretched", version, tmp_path), "start": {"length": value}}})
    (told,) = list_warnings(one) or [""]
    assert told.startswith(TAKEN) if named else not told
    _, found = ran(one, tmp_path / "out")
    assert found["one.length"][0] == pytest.approx(millimetres, rel=1e-15)
    assert load(tmp_path / "out" / "scenario.toml") == one


def test_numbers_in_si_units_and_zeros_are_not_named(tmp_path: Path) -> None:
    """0 mm is 0 m; 0 degC is not 0 K."""
    tables = {
        "ball": {"participant": fmu("ball", 2, tmp_path), "start": {"body.h": 0.002}},
        "one": {"participant": fmu("stretched", 2, tmp_path), "start": {"length": 0.0}},
    }
    assert list_warnings(scenario(tables)) == []


def test_a_start_time_other_than_the_runs_is_named(tmp_path: Path) -> None:
    file = describe2(tmp_path / "late.fmu", "", head='<DefaultExperiment startTime="5"/>')
    told = list_warnings(scenario({"one": {"participant": file}}))
    assert any("one: its default experiment begins at t = 5 s, the run at 0" in line for line in told)


@pytest.mark.parametrize(("version", "value", "number"), [(2, "other", 9), (3, "brass", 2), (3, 2, 2)])
def test_items_are_given_by_name_or_number(
    version: int, value: str | int, number: int, tmp_path: Path
) -> None:
    table = {"participant": fmu("stretched", version, tmp_path), "parameters": {"material": value}}
    summary, found = ran(scenario({"one": table}, stop_time=0.02), tmp_path / "out")
    assert summary.complete, summary.message
    np.testing.assert_array_equal(found["one.number"], number)


@pytest.mark.parametrize("version", VERSIONS)
def test_what_is_told_of_a_file_has_ranges_and_items(
    version: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And no word of what the file does not say."""
    ranged = V("length", "output", 1.0, unit="mm", initial="exact", more='min="0.5" max="20"')
    material = next(v for v in MODELS["stretched"].variables if v.name == "material")
    monkeypatch.setitem(MODELS, "ranged", Model((ranged, material)))
    shown = str(info(fmu("ranged", version, tmp_path))).splitlines()
    assert shown[1].split() == ["model", "ranged"]
    assert not [line for line in shown if line.startswith("by ") or "licence" in line]
    (length,) = (line for line in shown if line.startswith("length "))
    assert "0.5..20" in length.split()
    (choice,) = (line for line in shown if line.startswith("material "))
    assert choice.endswith("(steel = 1, brass = 2, other = 9)")
