"""FMUs that hold their inputs over a macro step: no signal serves them worse than hold, and all is said."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.analyses.stability.linearisation import open_linearisations
from orchestrator.analyses.stability.survey import survey
from orchestrator.assessment.diagnosis.facts import Facts
from orchestrator.assessment.diagnosis.suggestions import coupling
from orchestrator.masters import MASTERS
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.scenario import Scenario
from orchestrator.scenario.fmu_limits import FmuLimits
from orchestrator.scenario.system import build_system
from orchestrator.scenario.warnings import list_warnings

from .c_fmus import fmu
from .runs import never, ran, scenario

LINES = [
    "first.force -> second.force",
    "second.position -> first.other_position",
    "second.velocity -> first.other_velocity",
]


def masses(folder: Path, **changes: Any) -> Scenario:
    """Two masses, of which the second is an FMU that holds its force."""
    tables = {
        "first": {"component": "coupled_mass", "participant": "in-process", "start": {"position": 1.0}},
        "second": {"component": "sprung_mass", "participant": fmu("held_mass", 2, folder)},
    }
    return scenario(tables, **{"connections": LINES} | changes)


@pytest.mark.parametrize("name", MASTERS)
def test_a_loop_through_a_held_input_has_the_bits_of_held_signals(name: str, tmp_path: Path) -> None:
    found = {}
    for signal in ("hold", "linear", "hermite"):
        one = masses(tmp_path, master={"name": name, "extrapolation": signal})
        found[signal] = ran(one, tmp_path / signal)[1]["first.position"]
    np.testing.assert_array_equal(found["linear"], found["hold"])
    np.testing.assert_array_equal(found["hermite"], found["hold"])


def test_held_inputs_are_named_before_the_run(tmp_path: Path) -> None:
    (said,) = list_warnings(masses(tmp_path))
    assert "second.force" in said
    assert "gauss_seidel" in said
    assert "linear" in said


def test_nothing_is_advised_that_the_fmus_cannot_take(tmp_path: Path) -> None:
    one = masses(tmp_path, master={"name": "gauss_seidel", "extrapolation": "hold"})
    summary, _ = ran(one, tmp_path / "out")
    assert not any("extrapolation" in said for said in summary.suggestions)
    limits = FmuLimits(one)
    assert (limits.lowest_degree, limits.restorable, limits.controllable) == (0, True, True)
    facts = Facts(summary.steps, None, one)  # type: ignore[arg-type]
    assert "extrapolation" not in (coupling.suggest_held_inputs(facts) or "")


def test_the_estimated_error_has_that_of_held_inputs(tmp_path: Path) -> None:
    """Within a factor of two of that of a run; and no signal is advised that can't be taken."""
    more: dict[str, Any] = {"tolerance": {"second.position": 0.3}, "reference": {"enabled": True}}
    one = masses(tmp_path, **more)
    system = build_system(one)
    with open_linearisations(one, system, None) as made:
        found = survey(one, system, linearisations=made)
    assert {method.master.extrapolation for method in found.methods} <= {
        "hold",
        "linear",
    }
    summary = run(one, tmp_path / "out", never, Reporter(), figures=False)
    measured = summary.errors["second.position"].relative_rms
    assert found.own.errors[one.macro_step]["second.position"] == pytest.approx(measured, rel=0.5)
    assert measured > 1e-3


def test_a_derivative_of_a_held_input_is_named_before_the_run(tmp_path: Path) -> None:
    tables = {
        "body": {"participant": fmu("held_mass", 2, tmp_path)},
        "load": {"participant": fmu("inertia", 2, tmp_path)},
    }
    lines = ["body.velocity * 1 -> load.speed", "load.reaction * 1 -> body.force"]
    one = scenario(tables, connections=lines, master={"name": "jacobi", "extrapolation": "hold"})
    assert any("load.reaction" in said and "speed" in said for said in list_warnings(one))
