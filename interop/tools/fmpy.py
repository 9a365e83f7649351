"""FMPy: `simulate_fmu`, with the inputs as a table."""

from ..case import Case, report_loaded

TITLE = "FMPy"
REQUIREMENTS = ("fmpy",)
USE = "nothing"


def version() -> str:
    import fmpy

    return str(fmpy.__version__)


def values(case: Case) -> list[list[float]]:
    import fmpy
    import numpy as np

    table = np.zeros(case.steps, [("time", float), *((name, float) for name in case.inputs)])
    table["time"] = [i * case.step for i in range(case.steps)]
    for j, name in enumerate(case.inputs):
        table[name] = [row[j] for row in case.table]
    fmpy.read_model_description(case.fmu)
    report_loaded()
    found = fmpy.simulate_fmu(
        case.fmu, fmi_type="CoSimulation", stop_time=case.steps * case.step, output_interval=case.step,
        input=table, output=list(case.outputs),
    )  # fmt: skip
    return [[float(row[name]) for name in case.outputs] for row in found[1:]]
