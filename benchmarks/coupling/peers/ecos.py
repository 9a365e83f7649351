"""ecos through ecospy: Jacobi with held inputs.

Values are read with `get_real` after a step. They are those at its end, where ecos has already exchanged
them: outputs with direct feedthrough show the exchanged inputs, and not those that were held in the step.
"""

from __future__ import annotations

from typing import Any

from .answering import answer


def simulate(job: dict[str, Any]) -> list[list[float]]:
    from ecospy import EcosSimulation, EcosSimulationStructure

    with EcosSimulationStructure() as structure:
        for name, path in job["files"].items():
            structure.add_model(name, path)
        given = {f"{name}::{key}": v for name, values in job["values"].items() for key, v in values.items()}
        structure.add_parameter_set("given", given)
        for source, target in job["connections"]:
            structure.make_real_connection(_identifier(source), _identifier(target))
        with EcosSimulation(structure=structure, step_size=job["step"]) as simulation:
            if not simulation.init(parameter_set="given"):
                raise RuntimeError("ecos could not initialise the system")
            outputs = [_identifier(name) for name in job["outputs"]]
            values = []
            for _ in range(job["samples"]):
                simulation.step(job["every"])
                values.append([simulation.get_real(name) for name in outputs])
            simulation.terminate()
    return values


def _identifier(port: str) -> str:
    return port.replace(".", "::", 1)


if __name__ == "__main__":
    answer(simulate)
