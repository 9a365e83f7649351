"""Native FMUs against those in Python: `valve-train` in ecos, in a plain script and in our masters."""

import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path

from fmus.native.fmu import build as build_native
from fmus.native.machine_code import this_platform
from models.core.system import System
from orchestrator.masters import GaussSeidel, Iterated, Jacobi, Master, Newton
from orchestrator.stepping import FixedSteps, Stepper

from .loops import STEP, STEPS, build_files, run_master, run_script
from .measure import load_system, measure_medians

PYTHON, NATIVE = "in Python", "native"


def list_files(system: System) -> dict[str, dict[str, Path]]:
    """The FMU of every instance, by kind."""
    parts = {name: instance.component for name, instance in system.instances.items()}
    here = [this_platform()]
    return {
        PYTHON: build_files(system),
        NATIVE: {
            name: build_native(c.name, structure=c.structure, platforms=here) for name, c in parts.items()
        },
    }


def measure_rate(
    system: System,
    paths: Mapping[str, Path],
    master: Master,
    steps: Callable[[], Stepper] = lambda: FixedSteps(STEP),
) -> float:
    """Macro steps of our master per second of processor time."""
    return 1.0 / run_master(system, master, files=paths, steps=steps)


def run_ecos(system: System, paths: Mapping[str, Path]) -> float:
    """Macro steps per second of ecos: Jacobi, inputs held, at the FMUs' own start values."""
    from ecospy import EcosSimulation, EcosSimulationStructure

    with EcosSimulationStructure() as structure:
        for name in system.instances:
            structure.add_model(name, str(paths[name]))
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
    _, system = load_system("valve-train")
    controlled, controlled_system = load_system("valve-train-controlled")
    found = list_files(system)
    masters = {
        "gauss_seidel, hold": GaussSeidel("hold"),
        "gauss_seidel, quadratic": GaussSeidel("quadratic"),
        "jacobi, quadratic": Jacobi("quadratic"),
        "iterated, quadratic": Iterated("quadratic"),
        "iterated, hermite": Iterated("hermite"),
        "newton, quadratic": Newton("quadratic"),
    }
    ways: dict[str, Callable[[Mapping[str, Path]], float]] = {
        "plain fmpy script, inputs held": lambda paths: 1.0 / run_script(system, paths),
        **{name: partial(measure_rate, system, master=master) for name, master in masters.items()},
        "step control of valve-train-controlled": partial(
            measure_rate, controlled_system, master=controlled.build_master(), steps=controlled.build_steps
        ),
    }
    try:
        import ecospy  # noqa: F401

        ways["ecos, hold"] = partial(run_ecos, system)
    except (ImportError, OSError):
        yield "macro steps/s of valve-train in ecos", "not measured: ecospy or its libtbb12 is missing"
    for way, measured in ways.items():
        rate = measure_medians(
            {kind: partial(measured, paths=paths) for kind, paths in found.items()}, rounds=5
        )
        yield (
            f"macro steps/s of valve-train, FMUs in Python and native: {way}",
            f"{rate[PYTHON]:.0f}; {rate[NATIVE]:.0f} ({rate[NATIVE] / rate[PYTHON]:.1f} x)",
        )
