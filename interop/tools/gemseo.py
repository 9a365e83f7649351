"""GEMSEO: a discipline with the inputs as time series."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from ..case import Case, report_loaded

TITLE = "GEMSEO"
REQUIREMENTS = ("gemseo-fmu",)
USE = "nothing"
FINDINGS = (
    "It sets the inputs of the next step before it records the outputs of the last one. The comparison does "
    "the same.",
)
NEXT_INPUTS = True


def version() -> str:
    from importlib.metadata import version

    import gemseo_fmu  # noqa: F401

    return f"gemseo-fmu {version('gemseo-fmu')}"


def values(case: Case) -> list[list[float]]:
    found = _discipline(case, case.table, case.steps, case.outputs).execute()
    return [[float(found[name][i + 1]) for name in case.outputs] for i in range(case.steps)]


@contextmanager
def timing(case: Case) -> Iterator[Callable[[int], float]]:
    def seconds(steps: int) -> float:
        discipline = _discipline(case, [case.table[0]] * 2, steps, case.outputs[:1])
        began = time.perf_counter()
        discipline.execute()
        return time.perf_counter() - began

    yield seconds


def _discipline(case: Case, table: Sequence[Sequence[float]], steps: int, outputs: Sequence[str]) -> Any:
    from gemseo_fmu.disciplines.fmu_discipline import FMUDiscipline
    from gemseo_fmu.utils.time_series import TimeSeries

    discipline = FMUDiscipline(
        case.fmu,
        input_names=list(case.inputs) or None,
        output_names=list(outputs),
        initial_time=0.0,
        final_time=steps * case.step,
        time_step=case.step,
    )
    report_loaded()
    times = [i * case.step for i in range(len(table))]
    for j, name in enumerate(case.inputs):
        discipline.default_input_data[name] = TimeSeries(times, [row[j] for row in table])
    return discipline
