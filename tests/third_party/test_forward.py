"""Step control of FMUs that cannot restore their state."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.scenario import ScenarioError
from orchestrator.scenario.system import build_system
from orchestrator.scenario.warnings import list_warnings

from .masses import exact_position, masses
from .runs import ran

SECOND = "stateless_mass"


def test_its_error_falls_with_the_tolerance(tmp_path: Path) -> None:
    """Against the matrix exponential."""
    errors = []
    for tolerance in (1e-2, 1e-4):
        one = masses(
            SECOND, tmp_path, macro_step=1e-3, step_control={"estimator": "defect", "relative": tolerance}
        )
        summary, found = ran(one, tmp_path / str(tolerance))
        assert summary.complete
        errors.append(np.abs(found["first.position"] - exact_position(found["time"])).max())
    assert errors[1] < 0.05 * errors[0]


def test_what_it_cannot_promise_is_said_before_the_run(tmp_path: Path) -> None:
    said = list_warnings(masses(SECOND, tmp_path, step_control={"estimator": "defect"}))
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
        build_system(masses(SECOND, tmp_path, **changes))
