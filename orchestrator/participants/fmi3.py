"""FMI 3.0: an instance of an FMU for co-simulation.

Events are the FMU's own (event mode is not used), so are clocks. A step that it returns from early is gone on
with until its end.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from fmpy import fmi3
from fmpy.fmi3 import FMU3Slave

from models.quantities import Vector

from .description import REALS, TRUTHS, Description, Variable
from .standard import DISCARD, WARNING

# As fmi3Int64 is called by what holds it.
HELD = {"Enumeration": "Int64"}
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
        self._reached: float | None = None
        self._ended = False

    def instantiate(self, log: Callable[[int, bytes], None]) -> None:
        self._slave.instantiate(
            loggingOn=True, logMessage=lambda environment, status, category, message: log(status, message)
        )
        self._library, self._handle = self._slave.dll, ctypes.c_void_p(self._slave.component)
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
        return {}

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

    def steps(self, fail: Callable[[int, float, float], None]) -> Callable[[float, float], None]:
        call, handle = self._function("fmi3DoStep"), self._handle
        yes, begin, duration = ctypes.c_bool(True), ctypes.c_double(), ctypes.c_double()
        event, ended, early, last = ctypes.c_bool(), ctypes.c_bool(), ctypes.c_bool(), ctypes.c_double()
        told = [ctypes.byref(one) for one in (event, ended, early, last)]

        def advance(time: float, step: float) -> None:
            end = time + step
            begin.value, duration.value = time, step
            for _ in range(MAXIMUM_RETURNS):
                status = call(handle, begin, duration, yes, *told)
                self._ended = ended.value
                if status <= WARNING and not (early.value or ended.value):
                    return
                if status > WARNING or ended.value:
                    break
                begin.value, duration.value = last.value, end - last.value
                if duration.value <= 0.0:
                    return
            self._reached = last.value if early.value or status == DISCARD or ended.value else None
            fail(max(status, DISCARD), time, step)

        return advance

    def reached(self) -> float | None:
        return self._reached

    def ended(self) -> bool:
        return self._ended

    def save(self, state: ctypes.c_void_p) -> int:
        return self._save(self._handle, ctypes.byref(state))  # type: ignore[no-any-return]

    def restore(self, state: ctypes.c_void_p) -> int:
        return self._restore(self._handle, state)  # type: ignore[no-any-return]

    def release(self, state: ctypes.c_void_p) -> int:
        return self._release(self._handle, ctypes.byref(state))  # type: ignore[no-any-return]
