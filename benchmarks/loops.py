"""Loops over the FMUs of a system: a plain fmpy script, and our masters.

All call the same FMUs in the same order (Gauss-Seidel: set, step, get) and return processor seconds per macro
step, which other programs disturb less than wall time.
"""

import shutil
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

from fmus.build import build
from models.core.system import Instance, System
from orchestrator.engine.observer import Observer
from orchestrator.masters import Master
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.run.simulation import simulate
from orchestrator.stepping import FixedSteps, Stepper

from .measure import Clock

STEPS, STEP = 10_000, 2e-6


@dataclass
class Unit:
    """An initialised FMU with the references of what it exchanges."""

    slave: FMU2Slave
    folder: str
    inputs: list[int]
    sources: list[tuple[str, int]]
    outputs: list[int]

    def close(self) -> None:
        self.slave.terminate()
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def build_files(system: System) -> dict[str, Path]:
    """The FMU in Python of every instance."""
    parts = {name: instance.component for name, instance in system.instances.items()}
    return {name: build(c.name, structure=c.structure) for name, c in parts.items()}


def open_units(system: System, files: Mapping[str, Path]) -> dict[str, Unit]:
    """The system's FMUs, initialised, as a script of fmpy's user sets them up."""
    references: dict[str, dict[str, int]] = {}
    slaves, folders = {}, {}
    for name, path in files.items():
        description = read_model_description(str(path))
        references[name] = {v.name: v.valueReference for v in description.modelVariables}
        folders[name] = extract(str(path))
        slaves[name] = slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=folders[name],
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        slave.instantiate()
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        _set_values(slave, system.instances[name], {v.name: v for v in description.modelVariables})
        slave.exitInitializationMode()
    exchanged = {
        name: sorted({c.source.variable for c in system.connections if c.source.instance == name})
        for name in slaves
    }
    units = {}
    for name, slave in slaves.items():
        feeding = [c for c in system.connections if c.target.instance == name]
        ports = [c.source for c in feeding]
        units[name] = Unit(
            slave,
            folders[name],
            [references[name][c.target.variable] for c in feeding],
            [(port.instance, exchanged[port.instance].index(port.variable)) for port in ports],
            [references[name][variable] for variable in exchanged[name]],
        )
    return units


def _set_values(slave: FMU2Slave, instance: Instance, known: Mapping[str, Any]) -> None:
    """Parameters, start states and inputs of the instance."""
    starts = {instance.component.state.field(k).add_suffix("_start"): v for k, v in instance.start.items()}
    for key, value in {**instance.parameters, **starts, **instance.inputs}.items():
        kind, reference = known[key].type, [known[key].valueReference]
        if kind == "Real":
            slave.setReal(reference, [float(value)])
        elif kind == "Boolean":
            slave.setBoolean(reference, [bool(value)])
        else:
            slave.setInteger(reference, [int(value)])


def run_script(system: System, files: Mapping[str, Path]) -> float:
    """A loop as a user of fmpy writes it: setReal, doStep and getReal, inputs held."""
    units = open_units(system, files)
    values = {name: unit.slave.getReal(unit.outputs) for name, unit in units.items()}
    began = time.process_time()
    for n in range(STEPS):
        for name, unit in units.items():
            if unit.inputs:
                unit.slave.setReal(unit.inputs, [values[other][i] for other, i in unit.sources])
            unit.slave.doStep(currentCommunicationPoint=n * STEP, communicationStepSize=STEP)
            values[name] = unit.slave.getReal(unit.outputs)
    elapsed = time.process_time() - began
    for unit in units.values():
        unit.close()
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
