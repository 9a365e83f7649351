"""Step control of FMUs that cannot restore their state, or tell of no contact."""

import math

import numpy as np
import pytest

from orchestrator.scenario import ScenarioError
from orchestrator.scenario.system import build_system
from orchestrator.scenario.warnings import list_warnings

from .c_fmus import fmu
from .masses import exact_position, masses
from .runs import ran, scenario

SECOND = "stateless_mass"


def test_its_error_falls_with_the_tolerance(tmp_path):
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


def test_what_it_cannot_promise_is_said_before_the_run(tmp_path):
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
def test_what_does_not_go_is_refused_with_its_remedy(changes, said, tmp_path):
    with pytest.raises(ScenarioError, match=said):
        build_system(masses(SECOND, tmp_path, **changes))


STIFFNESS, HEIGHT, GRAVITY = 1e6, 0.1, 9.81
# Where the spring has all of the energy: k d^2 / 2 = g (h + d).
DEEPEST = (GRAVITY + math.sqrt(GRAVITY**2 + 2.0 * STIFFNESS * GRAVITY * HEIGHT)) / STIFFNESS


def test_an_explicit_master_with_step_control_meets_the_contact(tmp_path):
    one = scenario(
        {name: {"participant": fmu(name, 2, tmp_path)} for name in ("falling", "stop")},
        connections=["falling.position -> stop.position", "stop.force -> falling.force"],
        stop_time=0.16,
        step_control={"relative": 1e-6},
    )
    summary, found = ran(one, tmp_path / "out")
    assert summary.complete
    position, velocity = found["falling.position"], found["falling.velocity"]
    assert position.min() == pytest.approx(-DEEPEST, rel=0.02)
    energy = 0.5 * velocity**2 + GRAVITY * position + 0.5 * STIFFNESS * np.minimum(position, 0.0) ** 2
    assert energy[-1] == pytest.approx(GRAVITY * HEIGHT, rel=0.1)
