"""What changes at events only is held over a macro step: it has no values in between (FMI 2.0, 2.2.7)."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.scenario.warnings import list_warnings

from .c_fmus import fmu
from .runs import ran, scenario

LINES = [
    "switch.gear -> lookup.gear",
    "switch.gear -> lookup.level",
    "switch.on -> lookup.flag",
    "switch.ramp -> lookup.sampled",
]
CASES: list[tuple[int, dict[str, Any]]] = [
    (2, {}),
    (2, {"master": {"name": "jacobi", "extrapolation": "quadratic"}}),
    (3, {"master": {"name": "iterated", "extrapolation": "hermite"}}),
    (2, {"step_control": {"estimator": "step_doubling", "maximum_step": 0.02}, "stop_time": 0.2}),
]


@pytest.mark.parametrize(("version", "changes"), CASES)
def test_no_value_arrives_that_was_never_there(version: int, changes: dict[str, Any], tmp_path: Path) -> None:
    """A Real that is discrete and a Boolean, into Reals; and a discrete input samples a continuous value."""
    tables = {name: {"participant": fmu(name, version, tmp_path)} for name in ("switch", "lookup")}
    one = scenario(tables, connections=LINES, **changes)
    (told,) = [line for line in list_warnings(one) if "discrete" in line]
    assert told.startswith("switch.gear, switch.on: discrete, so held over each macro step")
    summary, found = ran(one, tmp_path / "out")
    assert summary.complete, summary.message
    assert set(found["switch.gear"]) == {0.0, 1.0}
    assert found["lookup.strange"][-1] == 0.0
    if one.step_control is None:  # which makes a step in two halves
        np.testing.assert_array_equal(found["lookup.seen"][1:], found["switch.ramp"][:-1])
