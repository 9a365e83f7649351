"""slider_crank.fmu, run in a process without the repository: its impacts do not depend on the step size."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from .conftest import Isolated

SPEED = 1000.0 * math.pi / 30.0
TURN = 2.0 * math.pi / SPEED

RUN = """
import random
NAMES = ["upper_impact_count", "lower_impact_count", "upper_impact_impulse", "lower_impact_impulse",
         "last_impact_time", "sliding"]

def place(slave, t):
    slave.set({{"crank_angle": {speed!r} * t, "crank_angle_der1": {speed!r}, "crank_speed": {speed!r}}})

def begin():
    slave = Instance({path!r}).initialize(**{start!r})
    place(slave, 0.0)
    return slave

def run(slave, cuts):
    for t, end in zip(cuts, cuts[1:]):
        place(slave, t)
        slave.step(t, end - t)
    return slave.get(NAMES)
"""


def code(path: Path, body: str, **start: float) -> str:
    return RUN.format(path=str(path), speed=SPEED, start=start) + body


@pytest.mark.parametrize("form", [0, 1, 2])
def test_pieces_of_any_size_give_the_impacts_of_one_run(
    fmu_files: dict[str, Path], isolated: Isolated, form: int, record
) -> None:
    """A chaotic motion over two turns: counts equal, times to 1e-12 s / (crank rad/s), impulses likewise.

    Rounding of 2e-16 a piece grows by e^(0.41 * 13) = 200 over the horizon.
    """
    body = f"""
random.seed(3)
end = {2.0 * TURN!r}
cuts = sorted([0.0, end] + [random.uniform(0.0, end) for _ in range(500)])
report([run(begin(), [0.0, end]), run(begin(), cuts)])
"""
    whole, pieces = isolated(code(fmu_files["slider_crank"], body, form=form, clearance=0.01 * 0.1386078))
    assert whole[0] > 4.0
    assert whole[1] > 2.0
    assert pieces[:2] == whole[:2]
    assert pieces[2:4] == pytest.approx(whole[2:4], rel=1e-10)
    quantity = "slider-crank in 500 pieces: time of the last impact (s)"
    record("FMUs", quantity, pieces[4], whole[4], "one step of two turns", tolerance=1e-12)


@pytest.mark.parametrize(("angle", "sliding"), [(13.775, 0.0), (15.0, 1.0), (18.0, 0.0)])
def test_restored_in_chatter_and_sliding_to_the_last_bit(
    fmu_files: dict[str, Path], isolated: Isolated, angle: float, sliding: float
) -> None:
    """lambda = 0.25, rho = 0.015: chatter ends at 13.7797 rad; saved before, while sliding, in flight."""
    body = f"""
first, other = begin(), begin()
end = {angle / SPEED!r}
mode = run(first, [0.0, end])[-1]
saved = first.saved_bytes()
cuts = [end + k * 1e-3 for k in range(40)]
run(other, [0.0, 0.01])
other.restore_bytes(saved)
report([mode, run(first, cuts), run(other, cuts), first.saved_bytes() == other.saved_bytes()])
"""
    friction = 5.0 * 0.05 * (0.00210 * 4.4482216152605 / 0.0254) * (5.4570 * 0.0254) ** 2 * SPEED
    mode, once, again, same = isolated(code(fmu_files["slider_crank"], body, form=0, joint_friction=friction))
    assert mode == sliding
    assert once == again
    assert same
