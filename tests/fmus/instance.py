"""One instance of a packaged FMU through fmpy, by names; and a script that runs code without this repository.

As a script (`python -I instance.py CODE [blocked module ...]`) it runs CODE with `Instance` and `report` in
its namespace, where nothing of this repository nor an installed pythonfmu can be imported.
"""

from __future__ import annotations

import ctypes
import json
import sys
from pathlib import Path
from typing import Any

OURS = ("models", "fmus", "orchestrator", "tests", "pythonfmu")


class _Blocker:
    def __init__(self, names: tuple[str, ...]) -> None:
        self.names = names

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> None:
        if name.partition(".")[0] in self.names:
            raise ImportError(f"{name} is blocked in this test")


class Instance:
    """An instance of the FMU at `path`, which is a file or a folder where it was unpacked."""

    def __init__(self, path: str | Path, name: str = "slave", logging: bool = False) -> None:
        from fmpy import calloc, extract, fmi2, free, read_model_description

        path = str(path)
        self.folder = str(extract(path)) if path.endswith(".fmu") else path
        self.description = read_model_description(self.folder, validate=False)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages: list[tuple[int, str, str]] = []
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log)
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        self.fmu = fmi2.FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.fmu.instantiate(callbacks=callbacks, loggingOn=logging)

    def _log(self, environment: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        self.messages.append((status, (category or b"").decode(), message.decode()))

    def names(self, causality: str) -> list[str]:
        return [v.name for v in self.variables.values() if v.causality == causality]

    def initialize(self, start_time: float = 0.0, **values: float) -> Instance:
        self.fmu.setupExperiment(startTime=start_time)
        self.set(values)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def set(self, values: dict[str, float]) -> None:
        for name, value in values.items():
            variable = self.variables[name]
            if variable.type == "Real":
                self.fmu.setReal([variable.valueReference], [value])
            elif variable.type == "Boolean":
                self.fmu.setBoolean([variable.valueReference], [bool(value)])
            else:
                self.fmu.setInteger([variable.valueReference], [int(value)])

    def get(self, names: list[str]) -> list[float]:
        found = []
        for name in names:
            variable = self.variables[name]
            read = {"Real": self.fmu.getReal, "Boolean": self.fmu.getBoolean}
            found.append(float(read.get(variable.type, self.fmu.getInteger)([variable.valueReference])[0]))
        return found

    def outputs(self) -> list[float]:
        return self.get(self.names("output") + self.names("local"))

    def step(self, t: float, h: float) -> None:
        self.fmu.doStep(t, h)

    def save(self) -> ctypes.c_void_p:
        return self.fmu.getFMUstate()

    def restore(self, state: ctypes.c_void_p) -> None:
        self.fmu.setFMUstate(state)

    def saved_bytes(self) -> bytes:
        state = self.save()
        data = self.fmu.serializeFMUstate(state)
        self.fmu.freeFMUstate(state)
        return data

    def restore_bytes(self, data: bytes) -> None:
        state = self.fmu.deSerializeFMUstate(data)
        try:
            self.restore(state)
        finally:
            self.fmu.freeFMUstate(state)

    def free(self) -> None:
        self.fmu.freeInstance()


def report(value: Any) -> None:
    """Print a value for the test that started this interpreter."""
    print("REPORT " + json.dumps(value))


if __name__ == "__main__":
    sys.meta_path.insert(0, _Blocker((*OURS, *sys.argv[2:])))
    exec(compile(sys.argv[1], "test", "exec"), {"Instance": Instance, "report": report})
