"""Loops over the FMUs of a system: a plain fmpy script, and our masters.

All call the same FMUs in the same order (Gauss-Seidel: set, step, get) and return processor seconds per macro
step, which other programs disturb less than wall time.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.simulation import apply_start_values, instantiate_fmu

from fmus.build import build
from models.core.system import Instance, System
from orchestrator.engine.observer import Observer
from orchestrator.masters import Master
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.run.simulation import simulate
from orchestrator.stepping import FixedSteps, Stepper

from .measure import Clock

STEPS, STEP = 10_000, 2e-6


def build_files(system: System) -> dict[str, Path]:
    """The FMU in Python of every instance."""
    parts = {name: instance.component for name, instance in system.instances.items()}
    return {name: build(c.name, structure=c.structure) for name, c in parts.items()}


def open_slave(path: Path, folder: str, instance: Instance) -> tuple[FMU2Slave, dict[str, int]]:
    """The FMU, initialised with the instance's values as a script of fmpy's user does, and its references."""
    described = read_model_description(str(path))
    slave = instantiate_fmu(extract(str(path), folder), described, "CoSimulation")
    starts = {instance.component.state.field(k).add_suffix("_start"): v for k, v in instance.start.items()}
    slave.setupExperiment(startTime=0.0)
    apply_start_values(slave, described, {**instance.parameters, **starts, **instance.inputs})
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    return slave, {v.name: v.valueReference for v in described.modelVariables}


def run_script(system: System, files: Mapping[str, Path]) -> float:
    """A loop as a user of fmpy writes it: setReal, doStep and getReal, inputs held."""
    with TemporaryDirectory() as folder:
        slaves, at = {}, {}
        for name, path in files.items():
            slaves[name], at[name] = open_slave(path, f"{folder}/{name}", system.instances[name])
        lines = [(c.source, c.target) for c in system.connections]
        read = {n: sorted({s.variable for s, _ in lines if s.instance == n}) for n in slaves}
        outputs = {n: [at[n][variable] for variable in read[n]] for n in slaves}
        inputs = {n: [at[n][t.variable] for _, t in lines if t.instance == n] for n in slaves}
        sources = {
            n: [(s.instance, read[s.instance].index(s.variable)) for s, t in lines if t.instance == n]
            for n in slaves
        }
        values = {n: slave.getReal(outputs[n]) for n, slave in slaves.items()}
        began = time.process_time()
        for k in range(STEPS):
            for n, slave in slaves.items():
                if inputs[n]:
                    slave.setReal(inputs[n], [values[other][i] for other, i in sources[n]])
                slave.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=STEP)
                values[n] = slave.getReal(outputs[n])
        elapsed = time.process_time() - began
        for slave in slaves.values():
            slave.terminate()
            slave.freeInstance()
    return elapsed / STEPS


def run_master(
    system: System,
    master: Master,
    observers: Sequence[Observer] = (),
    files: Mapping[str, Path] | None = None,
    steps: Callable[[], Stepper] = lambda: FixedSteps(STEP),
) -> float:
    """Our master, by default on the FMUs in Python."""
    paths = files or build_files(system)
    participants = {n: open_fmu(n, paths[n], instance) for n, instance in system.instances.items()}
    clock = Clock()
    try:
        statistics = simulate(system, participants, master, steps(), STEPS * STEP, [clock, *observers])
    finally:
        for participant in participants.values():
            participant.close()
    return clock.elapsed / statistics.macro_steps
