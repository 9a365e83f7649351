"""libcosim, through its Python package."""

import itertools

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
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    execution = CosimExecution.from_step_size(step_size=round(case.step * SECOND))
    slave = CosimLocalSlave(fmu_path=case.fmu, instance_name="unit")
    if not slave.ptr():  # add_local_slave would take it all the same, and crash
        raise RefusedError(_last_error())
    index = execution.add_local_slave(slave)
    report_loaded()
    manipulator, observer = CosimManipulator.create_override(), CosimObserver.create_last_value()
    execution.add_manipulator(manipulator)
    execution.add_observer(observer)
    inputs, outputs = case.find_references(case.inputs), case.find_references(case.outputs)
    found = []
    for row in case.table:
        manipulator.slave_real_values(index, inputs, row)
        if not execution.step(step_count=1):
            raise RefusedError(_last_error())
        found.append(observer.last_real_values(index, outputs))
    return found


def _last_error() -> str:
    from libcosimpy._internal import get_last_error_message

    return str(get_last_error_message())
