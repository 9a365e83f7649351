"""fmuloader: the standard's calls, one by one, from Python."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from ..case import Case, report_loaded

TITLE = "fmuloader"
REQUIREMENTS = ("fmuloader",)
USE = "a loop of your own"
FINDINGS = (
    "`Fmi2Slave` requires the functions of model exchange too. FMUs in Python are for co-simulation only and "
    "do not have them.",
)


def version() -> str:
    from importlib.metadata import version

    import fmuloader  # noqa: F401

    return version("fmuloader")


def values(case: Case) -> list[list[float]]:
    inputs, outputs = case.find_references(case.inputs), case.find_references(case.outputs)
    found = []
    with _open(case) as (unit, set_values, get_values):
        for i, row in enumerate(case.table):
            set_values(inputs, row)
            unit.do_step(i * case.step, case.step)
            found.append(get_values(outputs))
    return found


@contextmanager
def timing(case: Case) -> Iterator[Callable[[int], float]]:
    with _open(case) as (unit, set_values, _):
        set_values(case.find_references(case.inputs), case.table[0])
        done = 0

        def seconds(steps: int) -> float:
            nonlocal done
            began = time.perf_counter()
            for i in range(done, done + steps):
                unit.do_step(i * case.step, case.step)
            done += steps
            return time.perf_counter() - began

        yield seconds


@contextmanager
def _open(case: Case) -> Iterator[tuple[Any, Any, Any]]:
    from fmuloader.fmi2 import Fmi2Slave, Fmi2Type
    from fmuloader.fmi3 import Fmi3Slave

    kind = Fmi2Slave if case.fmi == 2 else Fmi3Slave
    with kind(case.fmu, model_identifier=case.identifier) as unit:
        if case.fmi == 2:
            unit.instantiate("unit", Fmi2Type.CO_SIMULATION, guid=case.token)
            report_loaded()
            unit.setup_experiment(start_time=0.0)
            unit.enter_initialization_mode()
        else:
            unit.instantiate_co_simulation("unit", instantiation_token=case.token)
            report_loaded()
            unit.enter_initialization_mode(start_time=0.0)
        unit.exit_initialization_mode()
        yield (
            (unit, unit.set_real, unit.get_real)
            if case.fmi == 2
            else (unit, unit.set_float64, unit.get_float64)
        )
        unit.terminate()
        unit.free_instance()
