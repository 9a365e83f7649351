"""FMI 2.0: an instance of an FMU for co-simulation, and its functions that run in every step.

Those are called with memory that is bound once: fmpy's own methods build lists at every call.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

from models.quantities import Vector

from .description import TRUTHS, Description, Variable
from .standard import WARNING

# fmi2StatusKind
LAST_SUCCESSFUL_TIME, TERMINATED = 2, 3


class Fmi2:
    """Implements `Standard`."""

    real_types = ("Real",)

    def __init__(self, name: str, description: Description, folder: str) -> None:
        self._slave = FMU2Slave(
            guid=description.token,
            unzipDirectory=folder,
            modelIdentifier=description.identifier,
            instanceName=name,
        )

    def instantiate(self, log: Callable[[int, bytes], None]) -> None:
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(
            lambda environment, name, status, category, message: log(status, message)
        )
        callbacks.allocateMemory = defaultCallbacks.allocateMemory
        callbacks.freeMemory = defaultCallbacks.freeMemory
        self._slave.instantiate(callbacks=callbacks, loggingOn=True)
        self._bind()

    def set_up(self, start_time: float, stop_time: float) -> None:
        self._slave.setupExperiment(startTime=start_time, stopTime=stop_time)

    def enter_initialization(self, start_time: float, stop_time: float) -> None:
        self._slave.enterInitializationMode()

    def exit_initialization(self) -> None:
        self._slave.exitInitializationMode()

    def set(self, variables: Sequence[Variable], values: Iterable[float]) -> None:
        (first, *_), reference = variables, [v.reference for v in variables]
        if first.type == "Real":
            self._slave.setReal(reference, [float(value) for value in values])
        elif first.type in TRUTHS:
            self._slave.setBoolean(reference, [bool(value) for value in values])
        else:
            self._slave.setInteger(reference, [int(value) for value in values])

    def get(self, variables: Sequence[Variable]) -> list[float]:
        (first, *_), reference = variables, [v.reference for v in variables]
        if first.type == "Real":
            return list(self._slave.getReal(reference))
        get = self._slave.getBoolean if first.type in TRUTHS else self._slave.getInteger
        return [float(value) for value in get(reference)]

    def serialise(self, state: ctypes.c_void_p) -> bytes:
        return bytes(self._slave.serializeFMUstate(state))

    def deserialise(self, data: bytes) -> ctypes.c_void_p:
        state: ctypes.c_void_p = self._slave.deSerializeFMUstate(data)
        return state

    def terminate(self) -> None:
        self._slave.terminate()

    def free(self) -> None:
        self._slave.freeInstance()

    # What runs in every step. Without argument types ctypes passes these objects as they are, which is what
    # makes a call cheap.

    def _bind(self) -> None:
        slave = self._slave
        # A Python FMU runs in this interpreter, which ctypes would let go for every call only for the FMU to
        # take it again; PyDLL keeps it.
        self._in_python = Path(slave.unzipDirectory, "resources", "slavemodule.txt").is_file()
        self._library = ctypes.PyDLL(None, handle=slave.dll._handle) if self._in_python else slave.dll
        self._handle = ctypes.c_void_p(slave.component)
        self._save = self._function("fmi2GetFMUstate")
        self._restore = self._function("fmi2SetFMUstate")
        self._release = self._function("fmi2FreeFMUstate")

    def _function(self, name: str) -> Any:
        function = self._library[name]  # a new object at every look-up, so fmpy's own stay as they are
        function.restype = ctypes.c_int
        return function

    def addresses(self) -> dict[str, int]:
        functions = {"set_real": "fmi2SetReal", "do_step": "fmi2DoStep", "get_real": "fmi2GetReal"}
        found = {key: ctypes.cast(self._library[name], ctypes.c_void_p) for key, name in functions.items()}
        return {key: address.value or 0 for key, address in found.items()} | {
            "component": self._handle.value or 0,
            "in_python": int(self._in_python),
            "fmi3": 0,
            "told": 0,
        }

    def setter(self, references: Any, values: Vector, fail: Callable[[int], None]) -> Callable[[], None]:
        return self._reals("fmi2SetReal", references, values, fail)

    def getter(self, references: Any, values: Vector, fail: Callable[[int], None]) -> Callable[[], None]:
        return self._reals("fmi2GetReal", references, values, fail)

    def _reals(
        self, function: str, references: Any, values: Vector, fail: Callable[[int], None]
    ) -> Callable[[], None]:
        if not len(references):
            return lambda: None
        call, handle = self._function(function), self._handle
        wanted, memory = ctypes.c_void_p(references.ctypes.data), ctypes.c_void_p(values.ctypes.data)
        count = ctypes.c_size_t(len(references))

        def transfer(kept: Any = (references, values)) -> None:  # keeps the memory alive
            status = call(handle, wanted, count, memory)
            if status > WARNING:
                fail(status)

        return transfer

    def input_derivatives(
        self, references: Any, orders: Any, values: Vector, fail: Callable[[int], None]
    ) -> Callable[[], None]:
        call, handle = self._function("fmi2SetRealInputDerivatives"), self._handle
        wanted, memory = ctypes.c_void_p(references.ctypes.data), ctypes.c_void_p(values.ctypes.data)
        count, order = ctypes.c_size_t(len(references)), ctypes.c_void_p(orders.ctypes.data)

        def transfer(kept: Any = (references, orders, values)) -> None:  # keeps the memory alive
            status = call(handle, wanted, count, order, memory)
            if status > WARNING:
                fail(status)

        return transfer

    def steps(self, fail: Callable[[int, float, float], None]) -> Callable[[float, float], None]:
        call, handle, yes = self._function("fmi2DoStep"), self._handle, ctypes.c_int(1)
        begin, duration = ctypes.c_double(), ctypes.c_double()

        def advance(time: float, step: float) -> None:
            begin.value, duration.value = time, step
            status = call(handle, begin, duration, yes)
            if status > WARNING:
                fail(status, time, step)

        return advance

    def reached(self) -> float | None:
        value = ctypes.c_double()
        status = self._function("fmi2GetRealStatus")(self._handle, LAST_SUCCESSFUL_TIME, ctypes.byref(value))
        return value.value if status <= WARNING else None

    def ended(self) -> bool:
        # pythonfmu's C layer says so of every discarded step, so that its answer means nothing.
        if self._in_python:
            return False
        value = ctypes.c_int()
        status = self._function("fmi2GetBooleanStatus")(self._handle, TERMINATED, ctypes.byref(value))
        return status <= WARNING and bool(value.value)

    def save(self, state: ctypes.c_void_p) -> int:
        return self._save(self._handle, ctypes.byref(state))  # type: ignore[no-any-return]

    def restore(self, state: ctypes.c_void_p) -> int:
        return self._restore(self._handle, state)  # type: ignore[no-any-return]

    def release(self, state: ctypes.c_void_p) -> int:
        return self._release(self._handle, ctypes.byref(state))  # type: ignore[no-any-return]
