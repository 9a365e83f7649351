"""What components are: their table, and the roles that decide it for an own one too."""

from dataclasses import replace
from pathlib import Path

import pytest

from models.catalogue import CATALOGUE
from models.core.roles import Cam, TranslatingFollower
from orchestrator.assessment.friction.judge import find_sliding
from orchestrator.report.mechanism import list_sketches
from orchestrator.scenario.components import write_page
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.study.speeds.subject import describe_numbers, find_flywheel

ROOT = Path(__file__).parents[2]


def test_the_published_page_is_current() -> None:
    """Otherwise: tribocosim components > docs/reference/components.md"""
    assert (ROOT / "docs" / "reference" / "components.md").read_text("utf-8") == write_page()


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_variable_of_a_component_has_a_row_with_its_unit(name: str) -> None:
    readme = (ROOT / "fmus" / name / "README.md").read_text("utf-8")
    assert f"(../../docs/reference/components.md#{name})" in readme
    component = CATALOGUE[name]()
    rows = {line.split("`")[1]: line for line in write_page([name]).splitlines() if line.startswith("| `")}
    for layout in (component.parameters, component.state, component.inputs, component.outputs):
        for field in layout.fields:
            if not field.quantity.internal:
                key = next(row for row in rows if row.split("[")[0] == field.name.split("[")[0])
                unit = rows[key].split(" | ")[1].strip()
                assert unit == ("" if field.quantity.unit == "1" else field.quantity.unit)


OWN = """from dataclasses import replace

from models.valve_train.tappet import tappet


def lifter(table_points: int = 0):
    return replace(tappet(table_points), name="lifter")
"""


@pytest.fixture
def own(tmp_path, monkeypatch):
    """The pushrod train with an own follower, which is a tappet by another name."""
    (tmp_path / "own_lifter.py").write_text(OWN, "utf-8")
    monkeypatch.chdir(tmp_path)
    parts = "components.tappet"
    return load("pushrod-train", [f"{parts}.component=own_lifter:lifter", f"{parts}.participant=in-process"])


def test_figures_drawings_and_friction_find_an_own_follower_by_its_role(own):
    shipped = load("pushrod-train")
    for find in (find_flywheel, describe_numbers):
        assert find(own) == find(shipped)
    assert find_sliding(build_system(own)) == find_sliding(build_system(shipped)) == {"cam_contact": "tappet"}
    drawn = [
        [sketch.content() for sketch in list_sketches(one, build_system(one).outputs.names)]
        for one in (own, shipped)
    ]
    assert drawn[0] == drawn[1]
    assert drawn[0]


def test_an_own_follower_takes_a_lift_table(own, tmp_path):
    rows = "\n".join(f"{angle}, {max(0.0, 8.0 - 0.004 * (angle - 180) ** 2):.4f}" for angle in range(360))
    (tmp_path / "lift.csv").write_text(f"angle [deg], lift [mm]\n{rows}\n", "utf-8")
    tables = own.components["tappet"].model_dump()
    changed = ["components.tappet.component=own_lifter:lifter", "components.tappet.participant=in-process"]
    table = load("pushrod-train", [*changed, "components.tappet.lift_table=lift.csv"]).components["tappet"]
    assert table.structure["table_points"] > 0
    assert tables["structure"].get("table_points", 0) == 0


@pytest.mark.parametrize("role", [Cam("no_angle"), TranslatingFollower()])
def test_a_role_promises_outputs(role):
    with pytest.raises(ValueError, match=r"flywheel: output '\w+', for events or a role, must be one of"):
        replace(CATALOGUE["flywheel"](), roles=(role,))
