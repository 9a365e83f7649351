"""PathSim: a block `CoSimulationFMU` with a source at every input."""

from collections.abc import Callable

from ..case import Case, report_loaded

TITLE = "PathSim"
REQUIREMENTS = ("pathsim-fmi", "pathsim", "fmpy")
USE = "nothing"
FINDINGS = (
    "It reads every output as one Real (`FMUWrapper.get_outputs_as_array`). Native FMUs answer with an "
    "error, as the standard demands. [Remove other "
    "outputs](../how-to/use-the-fmus.md#remove-outputs-that-are-not-single-reals).",
    "It records outputs one step too early: those at the end of a step have the time of its beginning.",
)


def version() -> str:
    from importlib.metadata import version

    import pathsim_fmi  # noqa: F401

    return f"{version('pathsim')} with pathsim-fmi {version('pathsim-fmi')}"


def values(case: Case) -> list[list[float]]:
    from pathsim import Connection, Simulation
    from pathsim.blocks import Scope, Source
    from pathsim_fmi import CoSimulationFMU

    def held(column: int) -> Callable[[float], float]:
        return lambda t: case.table[min(round(t / case.step), case.steps - 1)][column]

    unit = CoSimulationFMU(case.fmu, dt=case.step)
    report_loaded()
    scope = Scope(labels=list(case.outputs))
    blocks = {name: Source(held(j)) for j, name in enumerate(case.inputs)}
    connections = [Connection(block, unit[name]) for name, block in blocks.items()]
    connections += [Connection(unit[name], scope[j]) for j, name in enumerate(case.outputs)]
    simulation = Simulation([unit, *blocks.values(), scope], connections, dt=case.step, log=False)
    simulation.run((case.steps - 1) * case.step, adaptive=False)
    _, found = scope.read()
    return [[float(value) for value in row] for row in found.T]
