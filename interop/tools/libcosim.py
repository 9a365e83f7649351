"""libcosim, through its Python package."""

import itertools
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from ..case import Case, RefusedError, report_loaded

TITLE = "libcosim"
REQUIREMENTS = ("libcosimpy",)
USE = "nothing"
FMI = (2,)
FINDINGS = (
    "No FMI 3.0. `CosimExecution.add_local_slave` crashes with a slave that could not be made; "
    "`CosimLocalSlave.ptr()` tells whether it was.",
)

SECOND = 1_000_000_000  # it counts nanoseconds


def version() -> str:
    from importlib.metadata import version

    import libcosimpy.CosimExecution  # noqa: F401

    return f"libcosimpy {version('libcosimpy')}"


def steps(count: int, step: float) -> list[tuple[float, float]]:
    """Of whole nanoseconds; the size of a step is the difference of two times."""
    times = [i * round(step * SECOND) / SECOND for i in range(count + 1)]
    return [(begin, end - begin) for begin, end in itertools.pairwise(times)]


def values(case: Case) -> list[list[float]]:
    from libcosimpy.CosimObserver import CosimObserver

    execution, index, manipulator = _load(case)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    inputs, outputs = case.find_references(case.inputs), case.find_references(case.outputs)
    found = []
    for row in case.table:
        manipulator.slave_real_values(index, inputs, row)
        _step(execution, 1)
        found.append(observer.last_real_values(index, outputs))
    return found


@contextmanager
def timing(case: Case) -> Iterator[Callable[[int], float]]:
    execution, index, manipulator = _load(case)
    manipulator.slave_real_values(index, case.find_references(case.inputs), case.table[0])

    def seconds(steps: int) -> float:
        began = time.perf_counter()
        _step(execution, steps)
        return time.perf_counter() - began

    yield seconds


def _load(case: Case) -> tuple[Any, int, Any]:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimSlave import CosimLocalSlave

    execution = CosimExecution.from_step_size(step_size=round(case.step * SECOND))
    slave = CosimLocalSlave(fmu_path=case.fmu, instance_name="unit")
    if not slave.ptr():  # add_local_slave would take it all the same, and crash
        raise RefusedError(_last_error())
    index = execution.add_local_slave(slave)
    report_loaded()
    manipulator = CosimManipulator.create_override()
    execution.add_manipulator(manipulator)
    return execution, index, manipulator


def _step(execution: Any, count: int) -> None:
    if not execution.step(step_count=count):
        raise RefusedError(_last_error())


def _last_error() -> str:
    from libcosimpy._internal import get_last_error_message

    return str(get_last_error_message())
