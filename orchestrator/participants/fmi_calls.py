"""The functions of an FMU that run in every step, called with memory that is bound once.

fmpy's own methods build lists at every call.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fmpy.fmi2 import FMU2Slave

from models.quantities import Vector

WARNING = 1  # what is above it did not succeed

# fmi2StatusKind. (fmi2Terminated says nothing: pythonfmu's C layer answers true to every discarded step.)
LAST_SUCCESSFUL_TIME = 2


class Calls:
    """The FMU's functions that run in every step, with their arguments made once.

    Without argument types ctypes passes these objects as they are, which is what makes a call cheap.
    """

    def __init__(self, slave: FMU2Slave) -> None:
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
        """What compiled code needs to call the functions itself."""
        functions = {"set_real": "fmi2SetReal", "do_step": "fmi2DoStep", "get_real": "fmi2GetReal"}
        found = {key: ctypes.cast(self._library[name], ctypes.c_void_p) for key, name in functions.items()}
        return {key: address.value or 0 for key, address in found.items()} | {
            "component": self._handle.value or 0,
            "in_python": int(self._in_python),
        }

    def reals(
        self, function: str, references: Any, values: Vector, fail: Callable[[int], None]
    ) -> Callable[[], None]:
        """fmi2SetReal or fmi2GetReal between these variables (unsigned int) and the memory of `values`.

        `fail` is called with the status of a call that did not succeed.
        """
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

    def steps(self, fail: Callable[[int, float, float], None]) -> Callable[[float, float], None]:
        """fmi2DoStep from a time by a length; `fail` gets these as well, after the status."""
        call, handle, yes = self._function("fmi2DoStep"), self._handle, ctypes.c_int(1)
        begin, duration = ctypes.c_double(), ctypes.c_double()

        def advance(time: float, step: float) -> None:
            begin.value, duration.value = time, step
            status = call(handle, begin, duration, yes)
            if status > WARNING:
                fail(status, time, step)

        return advance

    def reached(self) -> float | None:
        """Last successful time after a discarded step, where the FMU says it."""
        value = ctypes.c_double()
        status = self._function("fmi2GetRealStatus")(self._handle, LAST_SUCCESSFUL_TIME, ctypes.byref(value))
        return value.value if status <= WARNING else None

    def save(self, state: ctypes.c_void_p) -> int:
        """fmi2GetFMUstate."""
        return self._save(self._handle, ctypes.byref(state))  # type: ignore[no-any-return]

    def restore(self, state: ctypes.c_void_p) -> int:
        """fmi2SetFMUstate."""
        return self._restore(self._handle, state)  # type: ignore[no-any-return]

    def release(self, state: ctypes.c_void_p) -> int:
        """fmi2FreeFMUstate."""
        return self._release(self._handle, ctypes.byref(state))  # type: ignore[no-any-return]
