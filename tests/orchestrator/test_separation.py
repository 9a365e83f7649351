"""A contact that opens and closes at speed is no instability of its coupling."""

from __future__ import annotations

import pytest

from orchestrator.participants import in_process
from orchestrator.run.simulation import simulate
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start

from .recorder import Recorder

SPEEDS = (3000, 4000, 5000, 7000)


def at_speed(rpm, *changes):
    """The scenario valve-train at a constant speed."""
    speed = [f"components.flywheel.parameters.{end}_speed='{rpm} rpm'" for end in ("initial", "final")]
    return load("valve-train", [*speed, *changes])


@pytest.mark.parametrize("step", [5e-6, 1e-6])
@pytest.mark.parametrize("rpm", SPEEDS)
def test_a_follower_that_leaves_its_cam_does_not_end_the_run(rpm, step):
    """One lift with steps of fixed length: below 3500 r/min the follower stays on its cam."""
    scenario = at_speed(rpm)
    system = resolve_start(scenario, build_system(scenario))
    units = {name: in_process(name, instance) for name, instance in system.instances.items()}
    recorder = Recorder()
    simulate(system, units, scenario.build_master(), step, 60.0 / rpm, [recorder])
    assert recorder.times[-1] == 60.0 / rpm
    assert (recorder["contact.load"].min() == 0.0) == (rpm > 3500)
