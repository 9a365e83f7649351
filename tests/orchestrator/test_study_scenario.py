"""A scenario as what is studied: a point is the run that the command makes."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from orchestrator.errors import RunError
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.scenario.files import load
from orchestrator.store.result_file import open_result
from orchestrator.study.source import compute_fingerprint
from orchestrator.study.task import evaluate

from .commands import IN_PROCESS
from .studies import plan_scenario, plan_study, refuse_build

SETTINGS = [text.removeprefix("--set=") for text in IN_PROCESS]
LIFT = "components.camshaft.parameters.lift"


def plan(rows: list[dict[str, Any]]) -> Any:
    fixed = {"stop_time": "2 ms"} | dict(text.split("=") for text in SETTINGS)
    return plan_scenario({"kind": "list", "rows": rows}, fixed=fixed)


def test_results_are_those_of_the_run(tmp_path: Path) -> None:
    study = plan([{LIFT: "9 mm", "macro_step": "10 us"}])
    found = study.subject.evaluate(study.points[0])
    assert set(found) == set(study.subject.results)
    scenario = load("valve-train", [*SETTINGS, "stop_time=2 ms", f"{LIFT}=9 mm", "macro_step=10 us"])
    summary = run(scenario, tmp_path, refuse_build, Reporter(Console(quiet=True)), figures=False)
    assert found["macro_steps"] == summary.macro_steps == 200
    assert found["iterations"] == summary.iterations
    for name, error in summary.errors.items():
        assert found[f"{name}.error"] == error.relative_rms
        assert found[f"{name}.uncertainty"] == error.uncertainty.relative_rms
    # Those of a contact are of all macro steps, of which every second one is recorded.
    contact = summary.contacts["contact"]
    assert found["contact.load.maximum"] == contact.largest_load
    assert found["contact.load.minimum"] == contact.least_load
    assert found["contact.maximum_pressure.maximum"] == contact.pressure
    assert (found["contact.separations"], found["contact.impact_load"]) == (0.0, 0.0)
    with open_result(tmp_path) as tree:
        for name, values in tree["coupled"].data_vars.items():
            if name not in ("contact.load", "contact.maximum_pressure"):
                assert found[f"{name}.minimum"] == values.min()
                assert found[f"{name}.maximum"] == values.max()
            assert found[f"{name}.mean"] == pytest.approx(np.mean(values.values), rel=1e-15, abs=0.0)


@pytest.mark.long
def test_an_oil_is_studied_over_grades_and_temperatures(tmp_path: Path) -> None:
    """Hotter, or of a thinner grade, it makes a thinner film."""
    oil, temperature = "components.contact.oil", "components.contact.temperature"
    rows = [
        {oil: "SAE 5W-30", temperature: "60 degC"},
        {oil: "SAE 5W-30", temperature: "120 degC"},
        {oil: "SAE 0W-16", temperature: "120 degC"},
    ]
    file = tmp_path / "oil.toml"
    file.write_text(
        'extends = "valve-train"\n[components.contact]\noil = "SAE 30"\ntemperature = "90 degC"\n'
    )
    fixed = {"stop_time": "2 ms", "reference.enabled": False} | dict(text.split("=") for text in SETTINGS)
    study = plan_study({"kind": "list", "rows": rows}, None, scenario=str(file), fixed=fixed)
    assert [point[temperature] for point in study.points] == [333.15, 393.15, 393.15]
    assert study.subject.describe(temperature).unit == "K"
    (told,) = study.subject.list_warnings(study.points[2])
    assert told.startswith("contact: SAE 0W-16 at 120 degC has a viscosity of")
    films = [study.subject.evaluate(point)["contact.steady_film_thickness.mean"] for point in study.points]
    assert films[0] > 2.0 * films[1] > 2.0 * films[2]


def test_a_run_that_fails_is_a_failed_point_with_its_message() -> None:
    study = plan([{"macro_step": "1 ms", LIFT: "9 mm"}, {"macro_step": "10 us", LIFT: "-9 mm"}])
    with pytest.raises(RunError, match="reduce macro_step"):
        study.subject.evaluate(study.points[0] | {"stop_time": 0.05, "reference.enabled": False})
    outcome = evaluate(
        study.subject, study.points[0] | {"stop_time": 0.05}, compute_fingerprint(study.subject)
    )
    assert "reduce macro_step" in outcome.message
    assert outcome.values["contact.load.maximum"] > 0.0
    with pytest.raises(ValueError, match="lift"):
        study.subject.evaluate(study.points[1])


def test_workers_of_another_version_do_not_evaluate() -> None:
    study = plan([{"macro_step": "10 us"}])
    found = evaluate(study.subject, study.points[0], {"tribocosim": "0" * 16})
    assert isinstance(found, str)
    assert found.startswith("computes with tribocosim ")
