"""CoFmuPy: a coordinator, with the inputs as literal streams."""

from typing import Any

from ..case import Case, report_loaded

TITLE = "CoFmuPy"
REQUIREMENTS = ("cofmupy",)
USE = "a stream or connection for every input"
FINDINGS = (
    "It reads every output as one Real (`Fmu2Handler.step`, `Fmu3Handler.step`). Native FMUs answer with an "
    "error, as the standard demands. [Remove other "
    "outputs](../how-to/use-the-fmus.md#remove-outputs-that-are-not-single-reals).",
    "It sets unconnected inputs to 0, whatever their start value (`DefaultMaster.init_simulation`).",
    "It records outputs one step too early: `DefaultMaster.do_step` gives them the time before the step.",
)


def version() -> str:
    from importlib.metadata import version

    import cofmupy  # noqa: F401

    return version("cofmupy")


def values(case: Case) -> list[list[float]]:
    from cofmupy import Coordinator

    streams = {
        name: {str(i * case.step): row[j] for i, row in enumerate(case.table)}
        for j, name in enumerate(case.inputs)
    }
    coordinator: Any = Coordinator()
    coordinator.start(
        {
            "fmus": [{"id": "unit", "name": "unit", "path": case.fmu}],
            "connections": [
                {"source": {"type": "literal", "values": stream}, "target": {"id": "unit", "variable": name}}
                for name, stream in streams.items()
            ],
            "data_storages": [],
            "cosim_method": "jacobi",
            "edge_sep": " -> ",
            "root": "",
        }
    )
    report_loaded()
    coordinator.run_simulation(case.step, case.steps * case.step)
    found = coordinator.get_results()
    return [[float(found["unit", name][i]) for name in case.outputs] for i in range(case.steps)]
