"""A host of FMUs that are WebAssembly components: wasmtime, with the calls of fmpy's `FMU3Slave`."""

import functools
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from fmpy.fmi1 import FMICallException

from ..instance import Instance3

wasmtime = pytest.importorskip("wasmtime", reason="needs the package wasmtime")
hosted = pytest.importorskip("wasmtime.component")

STATUS = ("ok", "warning", "discard", "error", "fatal")
ENGINE = wasmtime.Engine()


@functools.cache
def compiled(content: bytes) -> Any:
    return hosted.Component(ENGINE, content)


class Slave:
    def __init__(self, guid: str, unzipDirectory: str, modelIdentifier: str, instanceName: str) -> None:
        self.token, self.name = guid, instanceName
        self.file = Path(unzipDirectory, "binaries", "wasm32-wasip2", f"{modelIdentifier}.wasm")

    def instantiate(
        self,
        logMessage: Callable[..., None],
        intermediateUpdate: Callable[..., None] | None = None,
        loggingOn: bool = False,
        eventModeUsed: bool = False,
        earlyReturnAllowed: bool = False,
        requiredIntermediateVariables: list[int] | None = None,
    ) -> None:
        def log(store: Any, name: str, status: str, category: str, message: str) -> None:
            assert name == self.name
            logMessage(None, STATUS.index(status), category.encode(), message.encode())

        def update(store: Any, time: float, *told: bool) -> tuple[bool, float]:
            requested, wanted = [False], [time]
            intermediateUpdate(None, time, *told, requested, wanted)
            return requested[0], wanted[0]

        self.store, linker = wasmtime.Store(ENGINE), hosted.Linker(ENGINE)
        with linker.root() as root:
            for place, name, function in (
                ("callbacks", "log-message", log),
                ("intermediate-update-callbacks", "intermediate-update", update),
            ):
                with root.add_instance(f"fmi:fmi3/{place}@3.0.0") as imported:
                    imported.add_func(name, function)
        self.component = linker.instantiate(self.store, compiled(self.file.read_bytes()))
        asked = (False, loggingOn, eventModeUsed, earlyReturnAllowed, requiredIntermediateVariables or [])
        make = self.find("[static]co-simulation-instance.instantiate-co-simulation")
        self.make = lambda name: make(self.store, name, self.token, "", *asked)
        self.resource = self.make(self.name)
        if self.resource is None:
            raise FMICallException("instantiate", STATUS.index("error"))

    def find(self, function: str, interface: str = "co-simulation") -> Any:
        index = self.component.get_export_index(self.store, f"fmi:fmi3/{interface}@3.0.0")
        index = self.component.get_export_index(self.store, function, index)
        return self.component.get_func(self.store, index)

    def __getattr__(self, name: str) -> Callable[..., Any]:
        """getFloat64 and so on, of as many arguments as the component's method has: results have sizes of
        their own."""
        dashed = re.sub(r"(?=[A-Z])", "-", name.replace("UInt", "Uint").replace("FMU", "Fmu")).lower()
        method = self.find(f"[method]co-simulation-instance.{dashed}")
        sizes = len(method.type(self.store).params) - 1

        def call(*given: Any) -> Any:
            told = method(self.store, self.resource, *given[:sizes])
            if isinstance(told, str) and told != "ok":
                raise FMICallException(name, STATUS.index(told))
            return tuple(vars(told).values()) if isinstance(told, hosted.Record) else told

        return call

    def enterInitializationMode(self, startTime: float = 0.0) -> None:
        self.__getattr__("enterInitializationMode")(None, startTime, None)

    def doStep(self, time: float, step: float) -> tuple[bool, bool, bool, float]:
        reached, *said = self.__getattr__("doStep")(time, step, False)
        return (*said, reached)

    def freeInstance(self) -> None:
        self.resource.drop(self.store)


class Component(Instance3):
    """An instance of the FMU's component."""

    def open(self, path: str | Path, kind: Any, name: str) -> None:
        super().open(path, Slave, name)

    def saved_bytes(self) -> bytes:
        return self.fmu.getFMUState()

    def restore_bytes(self, data: bytes) -> None:
        self.fmu.setFMUState(data)
