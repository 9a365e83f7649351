"""ecos, through its Python package."""

from ..case import Case, RefusedError, report_loaded

TITLE = "ecos"
REQUIREMENTS = ("ecospy",)
USE = "Debian's libtbb12"


def version() -> str:
    from importlib.metadata import version

    import ecospy  # noqa: F401

    return f"ecospy {version('ecospy')}"


def values(case: Case) -> list[list[float]]:
    from ecospy import EcosSimulation, EcosSimulationStructure
    from ecospy.lib import EcosLib

    found = []
    with EcosSimulationStructure() as structure:
        structure.add_model("unit", case.fmu)
        report_loaded()
        structure.add_parameter_set("given", {f"unit::{name}": value for name, value in case.start.items()})
        with EcosSimulation(structure=structure, step_size=case.step) as simulation:
            if not simulation.init(parameter_set="given"):
                raise RefusedError(EcosLib.get_last_error())
            for row in case.rows():
                for name, value in row.items():
                    simulation.set_real(f"unit::{name}", value)
                simulation.step()
                found.append([simulation.get_real(f"unit::{name}") for name in case.outputs])
    return found
