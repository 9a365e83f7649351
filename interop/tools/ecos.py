"""ecos, through its Python package."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from ..case import Case, RefusedError, report_loaded

TITLE = "ecos"
REQUIREMENTS = ("ecospy",)
USE = "Debian's libtbb12"


def version() -> str:
    from importlib.metadata import version

    import ecospy  # noqa: F401

    return f"ecospy {version('ecospy')}"


def values(case: Case) -> list[list[float]]:
    found = []
    with _open(case) as simulation:
        for row in case.rows():
            for name, value in row.items():
                simulation.set_real(f"unit::{name}", value)
            simulation.step()
            found.append([simulation.get_real(f"unit::{name}") for name in case.outputs])
    return found


@contextmanager
def timing(case: Case) -> Iterator[Callable[[int], float]]:
    with _open(case) as simulation:

        def seconds(steps: int) -> float:
            began = time.perf_counter()
            simulation.step(steps)
            return time.perf_counter() - began

        yield seconds


@contextmanager
def _open(case: Case) -> Iterator[Any]:
    from ecospy import EcosSimulation, EcosSimulationStructure
    from ecospy.lib import EcosLib

    with EcosSimulationStructure() as structure:
        structure.add_model("unit", case.fmu)
        report_loaded()
        structure.add_parameter_set("given", {f"unit::{name}": value for name, value in case.start.items()})
        with EcosSimulation(structure=structure, step_size=case.step) as simulation:
            if not simulation.init(parameter_set="given"):
                raise RefusedError(EcosLib.get_last_error())
            yield simulation
