"""FMI 3.0: an instance of an FMU for co-simulation.

Events are the FMU's own (event mode is not used), so are clocks. A step that it returns from early is gone on
with until its end.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import fmi3
from fmpy.fmi3 import FMU3Slave

from models.quantities import Vector

from .description import REALS, TRUTHS, Description, Variable
from .standard import DISCARD, WARNING

# As fmi3Int64 is called by what holds it.
HELD = {"Enumeration": "Int64"}
# Bytes of what a step tells.
ENDED, EARLY = 1, 2
# Returns on the way through one step, before it counts as one that does not get on.
MAXIMUM_RETURNS = 10_000


class Fmi3:
    """Implements `Standard`."""

    real_types = ("Float64",)

    def __init__(self, name: str, description: Description, folder: str) -> None:
        self._slave = FMU3Slave(
            guid=description.token,
            unzipDirectory=folder,
            modelIdentifier=description.identifier,
            instanceName=name,
        )
        self._early = description.returns_early
        # What a step tells: event, end, early return (a byte each); at 8 the time that it has reached.
        self._told = np.zeros(2)

    def instantiate(self, log: Callable[[int, bytes], None]) -> None:
        self._slave.instantiate(
            loggingOn=True, logMessage=lambda environment, status, category, message: log(status, message)
        )
        # As FMI 2.0's: one that is in Python keeps the interpreter in its calls.
        self._in_python = Path(self._slave.unzipDirectory, "resources", "slavemodule.txt").is_file()
        own = self._slave.dll
        self._library = ctypes.PyDLL(None, handle=own._handle) if self._in_python else own
        self._handle = ctypes.c_void_p(self._slave.component)
        self._save = self._function("fmi3GetFMUState")
        self._restore = self._function("fmi3SetFMUState")
        self._release = self._function("fmi3FreeFMUState")

    def set_up(self, start_time: float, stop_time: float) -> None:
        pass

    def enter_initialization(self, start_time: float, stop_time: float) -> None:
        self._slave.enterInitializationMode(startTime=start_time, stopTime=stop_time)

    def exit_initialization(self) -> None:
        self._slave.exitInitializationMode()

    def set(self, variables: Sequence[Variable], values: Iterable[float]) -> None:
        make = float if variables[0].type in REALS else bool if variables[0].type in TRUTHS else int
        references, memory, call = self._memory("fmi3Set", variables)
        memory[:] = [make(value) for value in values]
        call(self._slave.component, references, len(references), memory, len(memory))

    def get(self, variables: Sequence[Variable]) -> list[float]:
        references, memory, call = self._memory("fmi3Get", variables)
        call(self._slave.component, references, len(references), memory, len(memory))
        return [float(value) for value in memory]

    def _memory(self, prefix: str, variables: Sequence[Variable]) -> tuple[Any, Any, Callable[..., Any]]:
        """Their references, each once; memory for all values; the function that transfers them."""
        kind = HELD.get(variables[0].type, variables[0].type)
        found = list(dict.fromkeys(v.reference for v in variables))
        references = (ctypes.c_uint * len(found))(*found)
        return (
            references,
            (getattr(fmi3, f"fmi3{kind}") * len(variables))(),
            getattr(self._slave, prefix + kind),
        )

    def serialise(self, state: ctypes.c_void_p) -> bytes:
        return bytes(self._slave.serializeFMUState(state))

    def deserialise(self, data: bytes) -> ctypes.c_void_p:
        state: ctypes.c_void_p = self._slave.deserializeFMUState(data)
        return state

    def terminate(self) -> None:
        self._slave.terminate()

    def free(self) -> None:
        self._slave.freeInstance()

    def _function(self, name: str) -> Any:
        function = self._library[name]  # a new object at every look-up, so fmpy's own stay as they are
        function.restype = ctypes.c_int
        return function

    def addresses(self) -> dict[str, int]:
        if self._early:  # which compiled code does not go on from
            return {}
        functions = {"set_real": "fmi3SetFloat64", "do_step": "fmi3DoStep", "get_real": "fmi3GetFloat64"}
        found = {key: ctypes.cast(self._library[name], ctypes.c_void_p) for key, name in functions.items()}
        return {key: address.value or 0 for key, address in found.items()} | {
            "component": self._handle.value or 0,
            "in_python": int(self._in_python),
            "fmi3": 1,
            "told": self._told.ctypes.data,
        }

    def setter(self, references: Any, values: Vector, fail: Callable[[int], None]) -> Callable[[], None]:
        return self._reals("fmi3SetFloat64", references, values, fail)

    def getter(self, references: Any, values: Vector, fail: Callable[[int], None]) -> Callable[[], None]:
        return self._reals("fmi3GetFloat64", references, values, fail)

    def _reals(
        self, function: str, references: Any, values: Vector, fail: Callable[[int], None]
    ) -> Callable[[], None]:
        if not len(references):
            return lambda: None
        call, handle = self._function(function), self._handle
        wanted, memory = ctypes.c_void_p(references.ctypes.data), ctypes.c_void_p(values.ctypes.data)
        count, size = ctypes.c_size_t(len(references)), ctypes.c_size_t(values.size)

        def transfer(kept: Any = (references, values)) -> None:  # keeps the memory alive
            status = call(handle, wanted, count, memory, size)
            if status > WARNING:
                fail(status)

        return transfer

    def input_derivatives(
        self, references: Any, orders: Any, values: Vector, fail: Callable[[int], None]
    ) -> Callable[[], None]:
        raise NotImplementedError("FMI 3 has no such call")

    def steps(self, fail: Callable[[int, float, float], None]) -> Callable[[float, float], None]:
        call, handle = self._function("fmi3DoStep"), self._handle
        yes, begin, duration = ctypes.c_bool(True), ctypes.c_double(), ctypes.c_double()
        told, at = self._told, self._told.ctypes.data
        places = [ctypes.c_void_p(at + offset) for offset in (0, 1, 2, 8)]
        marks = told[:1].view(np.uint8)

        def advance(time: float, step: float) -> None:
            end = time + step
            begin.value, duration.value = time, step
            for _ in range(MAXIMUM_RETURNS):
                status = call(handle, begin, duration, yes, *places)
                if status <= WARNING and not (marks[ENDED] or marks[EARLY]):
                    return
                if status > WARNING or marks[ENDED]:
                    break
                begin.value, duration.value = told[1], end - told[1]
                if duration.value <= 0.0:
                    return
            fail(max(status, DISCARD), time, step)

        return advance

    def reached(self) -> float | None:
        return float(self._told[1])

    def ended(self) -> bool:
        return bool(self._told[:1].view(np.uint8)[ENDED])

    def save(self, state: ctypes.c_void_p) -> int:
        return self._save(self._handle, ctypes.byref(state))  # type: ignore[no-any-return]

    def restore(self, state: ctypes.c_void_p) -> int:
        return self._restore(self._handle, state)  # type: ignore[no-any-return]

    def release(self, state: ctypes.c_void_p) -> int:
        return self._release(self._handle, ctypes.byref(state))  # type: ignore[no-any-return]
