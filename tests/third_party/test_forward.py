"""Step control of FMUs that cannot restore their state."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.oscillators.exact import two_masses
from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.system import build_system
from orchestrator.scenario.warnings import list_warnings

from .c_fmus import fmu
from .runs import ran, scenario
from .test_held_inputs import LINES


def masses(folder: Path, **changes: Any) -> Any:
    tables = {
        "first": {"component": "coupled_mass", "participant": "in-process", "start": {"position": 1.0}},
        "second": {"participant": fmu("stateless_mass", 2, folder)},
    }
    return scenario(tables, **{"connections": LINES, "macro_step": 1e-3, **changes})


def test_its_error_falls_with_the_tolerance(tmp_path: Path) -> None:
    """Against the matrix exponential."""
    coupled, sprung = CoupledMassParameters(), SprungMassParameters(mass=1.0, stiffness=10.0, damping=0.5)
    errors = []
    for tolerance in (1e-2, 1e-4):
        one = masses(tmp_path, step_control={"estimator": "defect", "relative": tolerance})
        summary, found = ran(one, tmp_path / str(tolerance))
        assert summary.complete
        true = two_masses(found["time"], coupled, sprung, np.array([1.0, 0.0, 0.0, 0.0]))
        errors.append(np.abs(found["first.position"] - true[:, 0]).max())
    assert errors[1] < 0.05 * errors[0]


def test_what_it_cannot_promise_is_said_before_the_run(tmp_path: Path) -> None:
    said = list_warnings(masses(tmp_path, step_control={"estimator": "defect"}))
    assert any("no step is made again" in line and "missed by any amount" in line for line in said)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"step_control": {}}, r"set step_control\.estimator = 'defect'"),
        ({"step_control": {"estimator": "residual_energy"}, "connections": []}, "use defect"),
        ({"step_control": {"estimator": "defect"}, "event_tolerance": 1e-6}, "makes no step again"),
    ],
)
def test_what_does_not_go_is_refused_with_its_remedy(
    changes: dict[str, Any], said: str, tmp_path: Path
) -> None:
    with pytest.raises(ScenarioError, match=said):
        build_system(masses(tmp_path, **changes))
