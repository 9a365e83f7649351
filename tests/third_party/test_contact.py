"""A mass falls from 0.1 m onto a stiff spring; both are FMUs that tell of no contact."""

import math
from pathlib import Path

import numpy as np
import pytest

from .c_fmus import fmu
from .runs import ran, scenario

STIFFNESS, HEIGHT, GRAVITY = 1e6, 0.1, 9.81
# Where the spring has all of the energy: k d^2 / 2 = g (h + d).
DEEPEST = (GRAVITY + math.sqrt(GRAVITY**2 + 2.0 * STIFFNESS * GRAVITY * HEIGHT)) / STIFFNESS


def test_an_explicit_master_with_step_control_meets_the_contact(tmp_path: Path) -> None:
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
