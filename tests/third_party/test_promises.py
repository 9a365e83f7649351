"""What an FMU says that it can do is tried before the run depends on it."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.scenario import Scenario, ScenarioError

from .c_fmus import fmu
from .runs import ran, scenario

HOLD = {"master": {"name": "jacobi", "extrapolation": "hold"}}


def forgetful(version: int, folder: Path, process: str = "shared", **changes: Any) -> Scenario:
    """With an FMU that counts the time, and restores all but its count."""
    tables = {
        "decay": {"participant": fmu("dahlquist", version, folder)},
        "one": {
            "participant": fmu("forgetful", version, folder),
            "process": process,
            **changes.pop("one", {}),
        },
    }
    return scenario(tables, connections=["decay.x -> one.u"], stop_time=0.2, **changes)


@pytest.mark.parametrize(
    ("version", "process", "changes"),
    [
        (2, "own", {}),
        (3, "shared", {"master": {"name": "jacobi", "extrapolation": "quadratic"}}),
        (2, "shared", HOLD | {"checkpoint_every": 30}),
    ],
)
def test_an_fmu_that_saves_a_part_of_its_state_is_not_taken_back(version, process, changes, tmp_path):
    summary, found = ran(forgetful(version, tmp_path, process, **changes), tmp_path / "out")
    np.testing.assert_allclose(found["one.passed"], found["time"], rtol=1e-13)
    (told,) = [str(line) for line in summary.tell() if "come back" in str(line)]
    assert told.startswith("one: the FMU does not come back to the state that it saved, though it says so")
    assert "passed is 0.02 after a step of 0.01 s that was 0.01 the first time" in told


@pytest.mark.parametrize(
    ("changes", "remedy"),
    [
        ({"master": {"name": "iterated"}}, "the master iterated repeats steps; take the master jacobi or"),
        (
            {"step_control": {"estimator": "step_doubling"}},
            r"\[step_control\] repeats steps; leave it out",
        ),
        ({"one": {"retries": 2}}, r"components\.one\.retries repeats steps; leave it out"),
    ],
)
def test_it_is_refused_where_steps_have_to_be_taken_back(changes, remedy, tmp_path):
    with pytest.raises(ScenarioError, match=rf"passed is 0\.02 .* but {remedy}"):
        ran(forgetful(2, tmp_path, **changes), tmp_path / "out")


def test_the_trial_leaves_no_trace(tmp_path):
    """An FMU that has been tried, for its checkpoints, runs as one that has not, to the last bit."""
    tables = {"decay": {"participant": fmu("dahlquist", 3, tmp_path)}}
    found = []
    for every in (30, 0):
        one = scenario(tables, checkpoint_every=every, **HOLD)
        summary, columns = ran(one, tmp_path / str(every))
        assert not [line for line in summary.tell() if "come back" in str(line)]
        found.append(columns["decay.x"])
    np.testing.assert_array_equal(*found)


def test_a_false_claim_to_take_derivatives_is_named_with_what_helps(tmp_path):
    tables = {
        "decay": {"participant": fmu("dahlquist", 2, tmp_path)},
        "integral": {"participant": fmu("claiming", 2, tmp_path)},
    }
    connected = {"connections": ["decay.x -> integral.u"]}
    summary, _ = ran(scenario(tables, **connected), tmp_path / "out")
    assert "integral: setting the derivatives of the inputs returned Error" in str(summary.message)
    assert "(canInterpolateInputs); set master.extrapolation = 'hold'" in str(summary.message)
    assert ran(scenario(tables, **connected, **HOLD), tmp_path / "hold")[0].complete
