"""A script over fmpy's own classes, as its users write it: Jacobi with held inputs.

Values are read after the step, at its end, with the inputs held in the step.
"""

from __future__ import annotations

import shutil
from typing import Any

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

from .answering import answer


def open_slaves(job: dict[str, Any]) -> tuple[dict[str, FMU2Slave], dict[str, dict[str, int]], list[str]]:
    """Slaves in initialization mode with their values set, value references by name, and their folders."""
    slaves, references, folders = {}, {}, []
    for name, path in job["files"].items():
        description = read_model_description(path)
        references[name] = {v.name: v.valueReference for v in description.modelVariables}
        folders.append(extract(path))
        slaves[name] = FMU2Slave(
            guid=description.guid,
            unzipDirectory=folders[-1],
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        slaves[name].instantiate()
        slaves[name].setupExperiment(startTime=0.0)
        slaves[name].enterInitializationMode()
        for key, value in job["values"][name].items():
            _set(slaves[name], references[name][key], value)
    return slaves, references, folders


def simulate(job: dict[str, Any]) -> list[list[float]]:
    slaves, references, folders = open_slaves(job)

    def port(text: str) -> tuple[str, int]:
        name, _, variable = text.partition(".")
        return name, references[name][variable]

    connections = [(port(source), port(target)) for source, target in job["connections"]]
    inputs = {name: [t[1] for _, t in connections if t[0] == name] for name in slaves}
    sources = {name: [s for s, t in connections if t[0] == name] for name in slaves}
    wanted = {name: sorted({s[1] for s, _ in connections if s[0] == name}) for name in slaves}

    def exchange() -> None:
        values = {}
        for name, slave in slaves.items():
            if wanted[name]:
                for reference, value in zip(wanted[name], slave.getReal(wanted[name]), strict=True):
                    values[name, reference] = value
        for name, slave in slaves.items():
            if inputs[name]:
                slave.setReal(inputs[name], [values[source] for source in sources[name]])

    for _ in slaves:  # values pass through one instance at a time
        exchange()
    for slave in slaves.values():
        slave.exitInitializationMode()

    outputs = [port(name) for name in job["outputs"]]
    rows, step, every = [], job["step"], job["every"]
    for n in range(every * job["samples"]):
        exchange()
        for slave in slaves.values():
            slave.doStep(currentCommunicationPoint=n * step, communicationStepSize=step)
        if (n + 1) % every == 0:
            rows.append([slaves[name].getReal([reference])[0] for name, reference in outputs])
    for slave, folder in zip(slaves.values(), folders, strict=True):
        slave.terminate()
        slave.freeInstance()
        shutil.rmtree(folder, ignore_errors=True)
    return rows


def _set(slave: FMU2Slave, reference: int, value: Any) -> None:
    if isinstance(value, bool):
        slave.setBoolean([reference], [value])
    elif isinstance(value, int):
        slave.setInteger([reference], [value])
    else:
        slave.setReal([reference], [value])


if __name__ == "__main__":
    answer(simulate)
