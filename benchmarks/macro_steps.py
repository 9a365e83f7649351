"""Macro steps per second of the `valve-train` FMUs: our master against a plain fmpy script.

The script does what a user of fmpy would write: the same exchange (Gauss-Seidel, inputs held) between
the same FMUs, with fmpy's own setReal, doStep and getReal. A bare loop over ctypes calls with prepared
arguments shows how little a master could cost at best.
"""

from __future__ import annotations

import ctypes
import shutil
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

from fmus.build import build
from models.core.quantities import Vector
from models.core.system import System
from orchestrator.engine.observer import Observer
from orchestrator.engine.step import Step
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.participants import open_fmu
from orchestrator.run import assembly
from orchestrator.run.simulation import simulate
from orchestrator.scenario.files import load

from .measure import medians

STEPS = 10_000
STEP = 2e-6


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


def units(system: System) -> dict[str, Unit]:
    """The system's FMUs as a script would set them up."""
    made = {}
    for name, instance in system.instances.items():
        path = str(build(instance.component.name, structure=instance.component.structure))
        description = read_model_description(path)
        reference = {v.name: v.valueReference for v in description.modelVariables}
        kinds = {v.name: v.type for v in description.modelVariables}
        folder = extract(path)
        slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        slave.instantiate()
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        for key, value in instance.parameters.items():
            if kinds[key] == "Real":
                slave.setReal([reference[key]], [value])
        for key, value in instance.start.items():
            stem, bracket, index = key.partition("[")
            slave.setReal([reference[f"{stem}_start{bracket}{index}"]], [value])
        slave.exitInitializationMode()
        feeding = [c for c in system.connections if c.target.instance == name]
        outputs = sorted({c.source.variable for c in system.connections if c.source.instance == name})
        made[name] = Unit(
            slave,
            folder,
            [reference[c.target.variable] for c in feeding],
            [(c.source.instance, _position(system, c.source)) for c in feeding],
            [reference[v] for v in outputs],
        )
    return made


def _position(system: System, port: Any) -> int:
    used = sorted({c.source.variable for c in system.connections if c.source.instance == port.instance})
    return used.index(port.variable)


def plain_script(system: System) -> float:
    """Macro steps per second of the plain script."""
    found = units(system)
    values = {name: unit.slave.getReal(unit.outputs) for name, unit in found.items()}
    began = time.perf_counter()
    now = 0.0
    for n in range(STEPS):
        for name, unit in found.items():
            if unit.inputs:
                unit.slave.setReal(unit.inputs, [values[other][i] for other, i in unit.sources])
            unit.slave.doStep(currentCommunicationPoint=now, communicationStepSize=STEP)
            values[name] = unit.slave.getReal(unit.outputs)
        now = (n + 1) * STEP
    rate = STEPS / (time.perf_counter() - began)
    for unit in found.values():
        unit.close()
    return rate


def bare_loop(system: System) -> float:
    """Macro steps per second of set, step and get with prepared arguments; values are copied by numpy."""
    found = units(system)
    now, length, yes = ctypes.c_double(), ctypes.c_double(STEP), ctypes.c_int(1)
    buffers = {name: np.zeros(len(unit.outputs)) for name, unit in found.items()}
    calls = []
    for name, unit in found.items():
        handle, library = ctypes.c_void_p(unit.slave.component), unit.slave.dll
        inputs = np.zeros(len(unit.inputs))
        sources = [(buffers[other], i) for other, i in unit.sources]
        arguments = []
        for references, memory in ((unit.inputs, inputs), (unit.outputs, buffers[name])):
            array = (ctypes.c_uint * len(references))(*references)
            arguments.append(
                (handle, array, ctypes.c_size_t(len(references)), ctypes.c_void_p(memory.ctypes.data))
            )
        set_real, do_step, get_real = (library[f] for f in ("fmi2SetReal", "fmi2DoStep", "fmi2GetReal"))
        calls.append(
            (
                set_real,
                arguments[0],
                do_step,
                (handle, now, length, yes),
                get_real,
                arguments[1],
                inputs,
                sources,
            )
        )
    began = time.perf_counter()
    for n in range(STEPS):
        now.value = n * STEP
        for (
            set_real,
            set_arguments,
            do_step,
            step_arguments,
            get_real,
            get_arguments,
            inputs,
            sources,
        ) in calls:
            for k, (buffer, i) in enumerate(sources):
                inputs[k] = buffer[i]
            set_real(*set_arguments)
            do_step(*step_arguments)
            get_real(*get_arguments)
    rate = STEPS / (time.perf_counter() - began)
    for unit in found.values():
        unit.close()
    return rate


@dataclass
class Sparse:
    """An observer that asks for the outputs of every n-th step, as one that records them does."""

    every: int
    steps: int = 0

    def begin(self, names: Sequence[str]) -> None:
        pass

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if self.steps % self.every == 0:
            outputs()
        self.steps += 1

    def end(self, complete: bool, message: str) -> None:
        pass


def coupled(system: System, master: Any, observers: Sequence[Observer] = ()) -> float:
    """Macro steps per second of our master."""
    participants = {
        name: open_fmu(name, build(instance.component.name, structure=instance.component.structure), instance)
        for name, instance in system.instances.items()
    }
    statistics = simulate(system, participants, master, STEP, STEPS * STEP, observers)
    for participant in participants.values():
        participant.close()
    return statistics.macro_steps / statistics.coupled_time_s


def rows() -> list[tuple[str, str]]:
    """Figures for the report."""
    scenario = load("valve-train")
    system = assembly.at_start(scenario, assembly.system_of(scenario))
    found = medians(
        {
            "plain fmpy script, inputs held": lambda: plain_script(system),
            "bare ctypes loop, inputs held": lambda: bare_loop(system),
            "gauss_seidel, hold": lambda: coupled(system, GaussSeidel("hold")),
            "gauss_seidel, quadratic": lambda: coupled(system, GaussSeidel("quadratic")),
            "gauss_seidel, quadratic, outputs of every step": lambda: coupled(
                system, GaussSeidel("quadratic"), [Sparse(1)]
            ),
            "gauss_seidel, quadratic, outputs of every 10th step": lambda: coupled(
                system, GaussSeidel("quadratic"), [Sparse(10)]
            ),
            "jacobi, quadratic": lambda: coupled(system, Jacobi("quadratic")),
            "iterated, quadratic": lambda: coupled(system, Iterated("quadratic")),
        }
    )
    script = found["plain fmpy script, inputs held"]
    return [
        (f"macro steps/s: {name}", f"{rate:.0f} ({rate / script:.2f} x script)")
        for name, rate in found.items()
    ]
