"""FMPy: `simulate_fmu`, with the inputs as a table."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from ..case import Case, report_loaded

TITLE = "FMPy"
REQUIREMENTS = ("fmpy",)
USE = "nothing"


def version() -> str:
    import fmpy

    return str(fmpy.__version__)


def values(case: Case) -> list[list[float]]:
    import numpy as np

    table = np.zeros(case.steps, [("time", float), *((name, float) for name in case.inputs)])
    table["time"] = [i * case.step for i in range(case.steps)]
    for j, name in enumerate(case.inputs):
        table[name] = [row[j] for row in case.table]
    found = _simulate(case, case.steps, input=table, output=list(case.outputs))
    return [[float(row[name]) for name in case.outputs] for row in found[1:]]


@contextmanager
def timing(case: Case) -> Iterator[Callable[[int], float]]:
    def seconds(steps: int) -> float:
        ends: list[float] = []

        def record_end(*_: Any) -> bool:
            ends.append(time.perf_counter())
            return True

        outputs = case.outputs[:1]
        _simulate(case, steps + 1, start_values=case.start, output=outputs, step_finished=record_end)
        return ends[-1] - ends[0]

    yield seconds


def _simulate(case: Case, steps: int, **how: Any) -> Any:
    import fmpy

    fmpy.read_model_description(case.fmu)
    report_loaded()
    stop = steps * case.step
    return fmpy.simulate_fmu(
        case.fmu, fmi_type="CoSimulation", stop_time=stop, output_interval=case.step, **how
    )
