"""Scenarios that extend others: what leaves, and what is replaced."""

from pathlib import Path

import numpy as np
import pytest

import tribocosim
from orchestrator.scenario.files import load


def write(folder: Path, text: str, base: str = "valve-train") -> Path:
    file = folder / "mine.toml"
    file.write_text(f'extends = "{base}"\n{text}')
    return file


def test_a_component_leaves_with_its_connections_and_tolerances(tmp_path: Path) -> None:
    file = write(tmp_path, 'without = ["components.contact"]\ntolerance = { "camshaft.bending" = 1e-3 }\n')
    scenario, parent = load(file), load("valve-train")
    assert set(scenario.components) == set(parent.components) - {"contact"}
    assert scenario.connections == [line for line in parent.connections if "contact." not in line]
    assert set(scenario.tolerance) == {"camshaft.bending"}


def test_connections_and_keys_leave(tmp_path: Path) -> None:
    line = "contact.load  ->  valve_spring.load"  # whatever its blanks
    file = write(tmp_path, f'without = ["{line}", "tolerance.contact.load", "output_step"]\n')
    scenario, parent = load(file), load("valve-train")
    assert set(parent.connections) - set(scenario.connections) == {"contact.load -> valve_spring.load"}
    assert set(parent.tolerance) - set(scenario.tolerance) == {"contact.load"}
    assert (scenario.output_step, parent.output_step) == (None, 2e-5)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('without = ["components.contcat"]', "no 'components.contcat'; did you mean contact?"),
        (
            'without = ["contact.laod -> valve_spring.load"]',
            "did you mean contact.load -> valve_spring.load?",
        ),
        ('without = "components.contact"', "must be a list"),
        ('without = ["components.contact.parameters.mass.more"]', "no 'components.contact.parameters"),
    ],
)
def test_what_is_not_there_is_named(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(tribocosim.MistakeError, match=said.replace("?", r"\?")):
        load(write(tmp_path, text))


def test_without_needs_a_scenario_to_take_from(tmp_path: Path) -> None:
    (tmp_path / "alone.toml").write_text('without = ["stop_time"]\n')
    with pytest.raises(tribocosim.MistakeError, match="only beside extends"):
        load(tmp_path / "alone.toml")


@pytest.mark.parametrize("as_setting", [False, True])
def test_a_law_replaces_the_lift_table_of_the_other(as_setting: bool, tmp_path: Path) -> None:
    angle = np.arange(360)
    lift = 4.0 * (1.0 + np.cos(np.radians(np.clip(angle - 180, -60, 60) * 3.0)))
    rows = (f"{a},{s:.6f}" for a, s in zip(angle, lift, strict=True))
    (tmp_path / "cam.csv").write_text("\n".join(["cam_deg,lift_mm", *rows]))
    table = '[components.camshaft]\nlift_table = "cam.csv"\n'
    base = write(tmp_path, table).rename(tmp_path / "base.toml")
    assert load(base).components["camshaft"].structure["table_points"] > 0
    law = '[components.camshaft.parameters]\nlaw = "cycloidal"\n'
    changed = (
        load(base, ["components.camshaft.parameters.law=cycloidal"])
        if as_setting
        else load(write(tmp_path, law, "base.toml"))
    )
    assert changed.components["camshaft"].structure.get("table_points", 0) == 0
    assert changed.components["camshaft"].parameters["law"] == "cycloidal"
