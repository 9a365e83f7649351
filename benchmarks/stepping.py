"""Macro steps per second of `valve-train` with FMUs in Python and native.

In a plain script of fmpy's, in ecos, and in our masters. All but ecos count processor time, which other
programs disturb less than wall time.
"""

import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.simulation import apply_start_values, instantiate_fmu

from fmus.build import build
from fmus.native.fmu import build as build_native
from fmus.native.machine_code import this_platform
from models.core.quantities import Vector
from models.core.system import Instance, System
from orchestrator.engine.observer import Observer
from orchestrator.engine.step import Step
from orchestrator.masters import MASTERS, Master
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.run.simulation import simulate
from orchestrator.stepping import FixedSteps, Stepper

from .measure import load_system, measure_medians

STEPS, STEP = 10_000, 2e-6
PYTHON, NATIVE = "in Python", "native"
# Masters with their signals.
COUPLINGS = (
    ("gauss_seidel", "hold"), ("gauss_seidel", "quadratic"), ("jacobi", "quadratic"),
    ("iterated", "quadratic"), ("iterated", "hermite"), ("newton", "quadratic"),
)  # fmt: skip
Files = Mapping[str, Path]


def list_files(system: System) -> dict[str, Files]:
    """The FMU of every instance, by kind."""
    parts = {name: instance.component for name, instance in system.instances.items()}
    here = [this_platform()]
    return {
        PYTHON: {name: build(c.name, structure=c.structure) for name, c in parts.items()},
        NATIVE: {n: build_native(c.name, structure=c.structure, platforms=here) for n, c in parts.items()},
    }


class Clock(Observer):
    """Takes the processor time of the stepping, `elapsed` (s)."""

    def observe(self, time_: float, outputs: Callable[[], Vector], step: Step) -> None:
        if step.length == 0.0:
            self._began = time.process_time()

    def end(self, complete: bool, message: str) -> None:
        self.elapsed = time.process_time() - self._began


def run_master(
    system: System, files: Files, master: Master, steps: Callable[[], Stepper] = lambda: FixedSteps(STEP)
) -> float:
    """Macro steps of our master per second."""
    participants = {n: open_fmu(n, files[n], instance) for n, instance in system.instances.items()}
    clock = Clock()
    try:
        statistics = simulate(system, participants, master, steps(), STEPS * STEP, [clock])
    finally:
        for participant in participants.values():
            participant.close()
    return statistics.macro_steps / clock.elapsed


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


def run_script(system: System, files: Files) -> float:
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
    return STEPS / elapsed


def run_ecos(system: System, files: Files) -> float:
    """ecos: Jacobi, inputs held, at the FMUs' own start values."""
    from ecospy import EcosSimulation, EcosSimulationStructure

    with EcosSimulationStructure() as structure:
        for name in system.instances:
            structure.add_model(name, str(files[name]))
        for connection in system.connections:
            ends = (str(end).replace(".", "::", 1) for end in (connection.source, connection.target))
            structure.make_real_connection(*ends)
        with EcosSimulation(structure=structure, step_size=STEP) as simulation:
            simulation.init()
            simulation.step(STEPS // 10)
            began = time.perf_counter()
            simulation.step(STEPS)
            return STEPS / (time.perf_counter() - began)


def measure() -> Iterator[tuple[str, str]]:
    """Figures and their values: rates, and how many times faster native ones are."""
    (_, system), (controlled, its_system) = load_system("valve-train"), load_system("valve-train-controlled")
    found = list_files(system)
    ways: dict[str, Callable[[Files], float]] = {
        "plain fmpy script, inputs held": partial(run_script, system),
        **{
            f"{name}, {signal}": partial(run_master, system, master=MASTERS[name](extrapolation=signal))
            for name, signal in COUPLINGS
        },
        "step control of valve-train-controlled": partial(
            run_master, its_system, master=controlled.build_master(), steps=controlled.build_steps
        ),
    }
    try:
        import ecospy  # noqa: F401

        ways["ecos, hold"] = partial(run_ecos, system)
    except (ImportError, OSError):
        yield "macro steps/s of valve-train in ecos", "not measured: ecospy or its libtbb12 is missing"
    for way, run in ways.items():
        rate = measure_medians({kind: partial(run, files=files) for kind, files in found.items()})
        yield (
            f"macro steps/s of valve-train, FMUs in Python and native: {way}",
            f"{rate[PYTHON]:.0f}; {rate[NATIVE]:.0f} ({rate[NATIVE] / rate[PYTHON]:.1f} x)",
        )
