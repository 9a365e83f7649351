"""Native FMUs give the numbers of components, alone and coupled, where both use the same libm."""

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from fmus.build import build
from models.core.quantities import Vector
from models.core.system import System
from orchestrator.masters import GaussSeidel, Jacobi, Master
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.participants.protocol import Participant
from orchestrator.run.simulation import simulate
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start
from tests.orchestrator.recorder import Recorder

from ..reference import Reference, schedule
from ..test_agreement import STEP as STEP_ALONE
from ..test_agreement import STEPS, expected_of, replay
from .names import EVERY

STEP = 5e-6


@cache
def valve_train() -> tuple[System, float]:
    """The scenario's system, set to its equilibrium, and where it ends (s): two turns of the cam."""
    scenario = load("valve-train")
    return resolve_start(scenario, build_system(scenario)), scenario.stop_time


def ran(participants: Mapping[str, Participant], master: Master, stop: float) -> Vector:
    """Every output after every macro step, the rows."""
    system, _ = valve_train()
    every = Recorder()
    simulate(system, participants, master, STEP, stop, [every])
    for participant in participants.values():
        participant.close()
    assert every.ended is not None
    complete, message = every.ended
    assert complete, message
    assert tuple(every.names) == tuple(system.outputs.names)
    assert len(every.times) == round(stop / STEP) + 1
    return every.rows


@pytest.fixture(scope="module")
def files(native_files, tmp_path_factory):
    """The FMU of every instance, by kind, with the sizes of the scenario."""
    folder = tmp_path_factory.mktemp("in-python")
    components = {name: instance.component for name, instance in valve_train()[0].instances.items()}
    return {
        "in Python": {name: build(c.name, folder, c.structure) for name, c in components.items()},
        "native": {name: native_files[c.name] for name, c in components.items()},
    }


def agree(
    files: Mapping[str, Mapping[str, Path]], master: Callable[[], Master], stop: float, record
) -> Vector:
    """The run, after all three kinds gave it."""
    system, _ = valve_train()
    instances = system.instances.items()
    here = ran({name: in_process(name, instance) for name, instance in instances}, master(), stop)
    for kind, paths in files.items():
        found = ran(
            {name: open_fmu(name, paths[name], instance) for name, instance in instances}, master(), stop
        )
        quantity = f"coupled valve train, FMUs {kind}, {stop:g} s: all outputs"
        record("FMUs", quantity, found, here, "components in process", tolerance=0)
    return here


@pytest.mark.long
@pytest.mark.parametrize("master", [lambda: GaussSeidel("quadratic"), lambda: Jacobi("hold")])
def test_both_turns_of_the_cam_are_the_same_to_the_last_bit(files, master, record):
    """Rise, nose and fall twice, with 24 000 steps; and it is a lift, not a rest."""
    system, stop = valve_train()
    found = agree(files, master, stop, record)
    lift = found[:, system.outputs.names.index("valve_spring.valve_lift")]
    assert 0.9 < np.max(lift) / system.p[system.parameters.names.index("camshaft.lift")] < 1.1


@pytest.mark.parametrize("name", EVERY)
def test_native_fmu_equals_component(name, native_files, isolated, tmp_path, record):
    """Outputs, their rates and energies; also between steps, and with steps of changing size."""
    reference = Reference(name)
    plan = schedule(reference.component, STEPS, STEP_ALONE)
    found, expected = replay(isolated, native_files[name], plan, tmp_path), expected_of(reference, plan)
    quantity = "outputs, rates and energies of native FMUs"
    record("FMUs", quantity, found, expected, "component in process", tolerance=0)
