"""A component that only its own steps move: analysed by its responses, refused by solvers of ODEs."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.component import Component
from models.core.system import ModelError
from orchestrator.analyses.stability.linearisation import Equations, open_linearisations
from orchestrator.analyses.stability.responses import Responses
from orchestrator.analyses.stability.survey import survey
from orchestrator.analyses.stability.trajectory import compute_rates, solve_course
from orchestrator.reporter import Reporter
from orchestrator.run.participants import ParticipantPlan
from orchestrator.run.pipeline import run
from orchestrator.scenario import Scenario, build_scenario
from orchestrator.scenario.system import Builder, build_system
from tests.models.fluid_layer import fluid_layer

from .dragged import LINES, SPRING, START, dragged

SHEETS = 5


def stepped_layer(sheets: int = SHEETS) -> Component:
    """The layer, as if its sheets had no differential equations."""
    return replace(fluid_layer(sheets), opaque=True)


@pytest.fixture(autouse=True)
def catalogued(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(CATALOGUE, "fluid_layer", fluid_layer)  # type: ignore[arg-type]
    monkeypatch.setitem(CATALOGUE, "stepped_layer", stepped_layer)  # type: ignore[arg-type]


def scenario(layer: str, **changes: object) -> Scenario:
    own = {"participant": "in-process"}
    tables = {
        "name": "dragged",
        "stop_time": 10e-3,
        "macro_step": 4e-4,
        "tolerance": {"plate.position": 1e-3},
        "start": "given",
        "components": {
            "plate": {"component": "sprung_mass", "parameters": SPRING, "start": START, **own},
            "layer": {"component": layer, "structure": {"sheets": SHEETS}, **own},
        },
        "connections": [f"{source} -> {target}" for source, target in LINES],
    }
    return build_scenario(tables | changes)


def never(name: str, structure: object, kind: str) -> Path:
    raise AssertionError(f"{name} is in process")


BUILD: Builder = never


@pytest.mark.long
def test_the_course_of_a_coupled_system_is_that_of_its_equations() -> None:
    """Outputs and rates. The layer's steps of 10 us are of second order: 5e-10 of its force."""
    times, quiet = np.arange(401) * 1e-5, lambda share: None
    equations, steps = dragged(SHEETS), dragged(SHEETS, {"opaque": True})
    one, other = solve_course(equations, times, 1e-13, quiet), solve_course(steps, times, 1e-13, quiet)
    assert list(other.states) == ["plate"]
    names = ["plate.position", "plate.velocity", "layer.force"]
    columns = [equations.outputs.names.index(name) for name in names]
    for first, second in (
        (one.outputs, other.outputs),
        (compute_rates(one, equations), compute_rates(other, steps)),
    ):
        size = np.abs(first[:, columns]).max(axis=0)
        assert np.all(np.abs(first - second)[:, columns].max(axis=0) <= 1e-9 * size)


@pytest.mark.long
def test_a_survey_goes_by_the_responses_of_what_has_no_equations() -> None:
    """And finds what one by the equations finds: the limit of stability, and the error at the step."""
    found = []
    for layer in ("fluid_layer", "stepped_layer"):
        one = scenario(layer)
        system, ours = build_system(one), dict.fromkeys(one.components, ParticipantPlan())
        with open_linearisations(one, system, ours) as sources:
            kinds = {name: type(source) for name, source in sources.items()}
            found.append(survey(one, system, ours, linearisations=sources).own)
        assert kinds == {"plate": Equations, "layer": Equations if layer == "fluid_layer" else Responses}
    # Responses are a linear system's to 1e-2 at worst (DOUBTFUL).
    assert found[1].limit == pytest.approx(found[0].limit, rel=1e-2)
    error = [own.errors[4e-4]["plate.position"] for own in found]
    assert error[1] == pytest.approx(error[0], rel=1e-2)


def test_equations_of_a_component_that_has_none_are_refused() -> None:
    with pytest.raises(ModelError, match=r"layer: fluid_layer has no ordinary .* by its responses"):
        Equations(dragged(changes={"opaque": True}), "layer")


def test_a_reference_that_cannot_be_solved_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with pytest.raises(
        ModelError, match=r"layer: fluid_layer with sheets = 5 .* \(reference\.enabled = false\)"
    ):
        run(scenario("stepped_layer"), out, BUILD, Reporter(), figures=False)
    assert not out.exists()


@pytest.mark.long
@pytest.mark.parametrize("opaque", [pytest.param(False, marks=pytest.mark.long), True])
def test_a_run_without_reference_ends_with_its_ledger(
    tmp_path: Path, opaque: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """For which a component of unknown equations is estimated."""

    def made(sheets: int = SHEETS) -> Component:
        return replace(fluid_layer(sheets), opaque=opaque)

    name = f"layer_{opaque}"
    monkeypatch.setitem(CATALOGUE, name, made)  # type: ignore[arg-type]
    one = scenario(name, reference={"enabled": False}, energy={"ledger": True})
    summary = run(one, tmp_path / "out", BUILD, Reporter(), figures=False)
    assert summary.complete, summary.message
    bond = summary.energy.bonds["layer.force * plate.velocity"]
    assert bond.estimated == (["layer"] if opaque else [])
    assert bond.taken != 0.0
