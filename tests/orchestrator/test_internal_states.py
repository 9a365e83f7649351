"""States that are no variables, as scenarios meet them: not at all."""

import pytest

from models.catalogue import CATALOGUE
from orchestrator.scenario import Scenario, ScenarioError, build_scenario
from orchestrator.scenario.checks import list_required_variables
from orchestrator.scenario.schema import describe_component
from orchestrator.scenario.system import build_system, resolve_start
from tests.models.fluid_layer import fluid_layer


@pytest.fixture(autouse=True)
def catalogued(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(CATALOGUE, "fluid_layer", fluid_layer)  # type: ignore[arg-type]


@pytest.fixture
def tables() -> dict:
    return {
        "name": "dragged",
        "stop_time": 1e-3,
        "macro_step": 1e-5,
        "tolerance": {"layer.force": 1e-3},
        "start": "given",
        "components": {
            "plate": {"component": "falling_mass", "start": {"velocity": 0.1}},
            "layer": {"component": "fluid_layer", "structure": {"sheets": 5}},
        },
        "connections": ["plate.velocity -> layer.velocity", "layer.force -> plate.force"],
    }


def made(tables: dict, **changes: object) -> Scenario:
    return build_scenario(tables | changes)


def test_an_internal_state_has_no_start_in_a_scenario(tables: dict) -> None:
    """Also where it is set to what it starts with: it is not the user's to set."""
    tables["components"]["layer"]["start"] = {"sheet_velocity[2]": 0.0}
    with pytest.raises(
        ScenarioError, match=r"layer\.start\.sheet_velocity\[2\]: .*sets this state itself.*leave it out"
    ):
        made(tables)


def test_a_wrong_name_is_not_answered_with_internal_ones(tables: dict) -> None:
    tables["components"]["layer"]["start"] = {"sheet_velocity": 0.0}
    with pytest.raises(ScenarioError, match="no such state; known: impulse"):
        made(tables)


def test_the_schema_knows_no_internal_state_and_the_least_size_of_each_component() -> None:
    table = describe_component("fluid_layer")["properties"]
    assert list(table["start"]["properties"]) == ["impulse"]
    assert "patternProperties" not in table["start"]
    assert table["structure"]["properties"]["sheets"]["minimum"] == 0
    spring = describe_component("valve_spring")["properties"]["structure"]["properties"]
    assert spring["coil_masses"]["minimum"] == 1


def test_an_equilibrium_leaves_internal_states_as_they_start(tables: dict) -> None:
    """And gives participants start values of the others alone, as only these are variables of an FMU."""
    tables["components"]["plate"]["parameters"] = {"gravity": 0.0}
    scenario = made(tables, start="equilibrium")
    resting = resolve_start(scenario, build_system(scenario))
    assert list(resting.instances["layer"].start) == ["impulse"]
    assert "sheet_velocity_start[1]" not in list_required_variables("layer", resting, "equilibrium")
