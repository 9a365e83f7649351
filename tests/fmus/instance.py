"""One instance of a packaged FMU through fmpy, by names; and a script that runs code without this repository.

As a script (`python -I instance.py CODE [blocked module ...]`) it runs CODE with `Instance` and `report` in
its namespace, where nothing of this repository nor an installed pythonfmu can be imported.
"""

from __future__ import annotations

import contextlib
import copy
import ctypes
import json
import math
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

OURS = ("models", "fmus", "orchestrator", "tests", "pythonfmu")


class Blocker:
    def __init__(self, names: tuple[str, ...]) -> None:
        self.names = names

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> None:
        if name.partition(".")[0] in self.names:
            raise ImportError(f"{name} is blocked in this test")


class Instance:
    """An instance of the FMU at `path`, which is a file or a folder where it was unpacked."""

    # In the names of functions of saved states.
    STATE, DESERIALIZE = "FMUstate", "deSerialize"

    def __init__(self, path: str | Path, name: str = "slave", logging: bool = False) -> None:
        from fmpy import calloc, fmi2, free

        self.open(path, fmi2.FMU2Slave, name)
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log)
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        self.callbacks = {"callbacks": callbacks}
        self.fmu.instantiate(**self.callbacks, loggingOn=logging)

    @contextlib.contextmanager
    def exchanging(self, **values: Any) -> Iterator[Any]:
        """An instance of the same FMU for model exchange, as fmpy's model, initialised with these values."""
        from fmpy import fmi2, fmi3

        about = self.description
        second = about.fmiVersion.startswith("2")
        model = (fmi2.FMU2Model if second else fmi3.FMU3Model)(
            guid=about.guid,
            unzipDirectory=self.folder,
            modelIdentifier=about.modelExchange.modelIdentifier,
            instanceName="model",
        )
        model.instantiate(**self.callbacks)
        if second:
            model.setupExperiment()
        other = copy.copy(self)
        other.fmu = model
        other.set(values)
        model.enterInitializationMode()
        model.exitInitializationMode()
        yield model
        model.freeInstance()

    def open(self, path: str | Path, kind: Any, name: str) -> None:
        """Read the description and load the library, of fmpy's class `kind`."""
        from fmpy import extract, read_model_description

        path = str(path)
        self.folder = str(extract(path)) if path.endswith(".fmu") else path
        self.description = read_model_description(self.folder, validate=False)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages: list[tuple[int, str, str]] = []
        self.fmu = kind(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )

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
        """Outputs, their rates and energies, without what hosts need that integrate by themselves."""
        names = self.names("output") + self.names("local")
        exchange = ("state.", "der(state.", "event_indicator")
        return self.get([name for name in names if not name.startswith(exchange)])

    def step(self, t: float, h: float) -> Any:
        self.fmu.doStep(t, h)

    def save(self) -> ctypes.c_void_p:
        return getattr(self.fmu, f"get{self.STATE}")()

    def restore(self, state: ctypes.c_void_p) -> None:
        getattr(self.fmu, f"set{self.STATE}")(state)

    def release(self, state: ctypes.c_void_p) -> None:
        getattr(self.fmu, f"free{self.STATE}")(state)

    def saved_bytes(self) -> bytes:
        state = self.save()
        data = getattr(self.fmu, f"serialize{self.STATE}")(state)
        self.release(state)
        return data

    def restore_bytes(self, data: bytes) -> None:
        state = getattr(self.fmu, f"{self.DESERIALIZE}{self.STATE}")(data)
        try:
            self.restore(state)
        finally:
            self.release(state)

    def free(self) -> None:
        self.fmu.freeInstance()


class Instance3(Instance):
    """The same of an FMU of FMI 3.0; `asked` is what fmpy's `FMU3Slave.instantiate` takes.

    `update(time, setting, finished, possible)` is called from within steps, and returns the time at which the
    step shall end, or None.
    """

    STATE, DESERIALIZE = "FMUState", "deserialize"

    def __init__(
        self, path: str | Path, name: str = "slave", logging: bool = False, update: Any = None, **asked: Any
    ) -> None:
        from fmpy import fmi3

        self.open(path, fmi3.FMU3Slave, name)
        self.events = bool(asked.get("eventModeUsed"))
        self.update = update
        called = {} if update is None else {"intermediateUpdate": self._updated}
        self.callbacks = {"logMessage": self._say}
        self.fmu.instantiate(loggingOn=logging, **self.callbacks, **called, **asked)

    def _say(self, environment: Any, status: int, category: bytes, message: bytes) -> None:
        self.messages.append((status, category.decode(), message.decode()))

    def _updated(
        self,
        environment: Any,
        time: float,
        setting: bool,
        getting: bool,
        finished: bool,
        possible: bool,
        requested: Any,
        wanted: Any,
    ) -> None:
        end = self.update(time, setting, finished, possible)
        if end is not None:
            requested[0], wanted[0] = True, end

    def initialize(self, start_time: float = 0.0, **values: float) -> Instance3:
        self.set(values)
        self.fmu.enterInitializationMode(startTime=start_time)
        self.fmu.exitInitializationMode()
        if self.events:
            self.handle_events()
        return self

    def handle_events(self) -> None:
        """In event mode; stepping goes on afterwards."""
        assert not self.fmu.updateDiscreteStates()[0]
        self.fmu.enterStepMode()

    def size(self, name: str) -> int:
        """Elements of a variable."""
        return math.prod(self.variables[name].shape or ())

    def set(self, values: dict[str, Any]) -> None:
        """Scalars, arrays by a list of their elements, and elements by their names."""
        for name, value in values.items():
            if name in self.variables:
                self._call("set", name, value if isinstance(value, list) else [value])
            else:
                array, place = self._element(name)
                whole = self._call("get", array, self.size(array))
                self._call("set", array, [*whole[:place], value, *whole[place + 1 :]])

    def get(self, names: list[str]) -> list[float]:
        """The elements of these variables, one after the other; elements by their names."""
        found: list[float] = []
        for name in names:
            if name in self.variables:
                found += map(float, self._call("get", name, self.size(name)))
            else:
                array, place = self._element(name)
                found.append(float(self._call("get", array, self.size(array))[place]))
        return found

    def _element(self, name: str) -> tuple[str, int]:
        """The array of which it is an element, and its place there; der(x[2]) is one of der(x)."""
        (index,) = re.findall(r"\[(\d+)\]", name)
        return name.replace(f"[{index}]", ""), int(index) - 1

    def _call(self, what: str, name: str, given: Any) -> Any:
        variable = self.variables[name]
        kind = {"Enumeration": "Int64"}.get(variable.type, variable.type)
        if what == "set":
            whole = {"Float64": float, "Boolean": bool}.get(kind, int)
            given = [whole(value) for value in given]
        return getattr(self.fmu, what + kind)([variable.valueReference], given)

    def step(self, t: float, h: float) -> tuple[bool, bool, bool, float]:
        """eventHandlingNeeded, terminateSimulation, earlyReturn, lastSuccessfulTime."""
        return self.fmu.doStep(t, h)


def report(value: Any) -> None:
    """Print a value for the test that started this interpreter."""
    print("REPORT " + json.dumps(value))


if __name__ == "__main__":
    sys.meta_path.insert(0, Blocker((*OURS, *sys.argv[2:])))
    exec(
        compile(sys.argv[1], "test", "exec"), {"Instance": Instance, "Instance3": Instance3, "report": report}
    )
