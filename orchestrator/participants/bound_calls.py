"""Fast calls of an FMU's functions that run in every step.

Their arguments are bound once. ctypes functions without argument types pass them unchanged, while fmpy's
methods build lists at every call.
"""

import ctypes
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from models.core.quantities import Vector

from .description import Description, Variable
from .fmi_instance import OK, WARNING, status_name
from .library import open_library


class ArrayLayout:
    """The memory of a call for scalars and elements of arrays: unique references, number of values (a call
    transfers whole arrays), and the places of the variables among these."""

    def __init__(self, variables: Iterable[Variable]) -> None:
        first: dict[int, int] = {}
        self.places: list[int] = []
        self.size = 0
        for v in variables:
            if v.reference not in first:
                first[v.reference] = self.size
                self.size += v.size
            self.places.append(first[v.reference] + v.place)
        self.references = tuple(first)


class BoundCalls:
    """The calls that FMI 2 and FMI 3 share, on fmpy's `slave`."""

    slave: Any
    warned = 0  # calls that returned a warning

    def _open(self, kind: Any, name: str, about: Description, folder: str) -> None:
        """Load the library; what fmpy calls counts warnings and raises where a status is none."""
        self.slave = open_library(kind, name, about, folder)
        plain = self.slave._call

        def call(function: str, *arguments: Any) -> Any:
            status = plain(function, *arguments)
            if self.slave._functions[function].restype is ctypes.c_int:
                if status < OK:
                    raise RuntimeError(f"{function} returned {status_name(status)}")
                self.warned += status == WARNING
            return status

        self.slave._call = call

    def _bind(self, *states: str) -> None:
        """Bind the instance and its functions that save, restore and release states, by their names."""
        slave = self.slave
        # A Python FMU runs in this interpreter: PyDLL keeps its lock, which the FMU would only take again.
        self._in_python = Path(slave.unzipDirectory, "resources", "slavemodule.txt").is_file()
        self._library = ctypes.PyDLL(None, handle=slave.dll._handle) if self._in_python else slave.dll
        self._handle = ctypes.c_void_p(slave.component)
        if states:
            self._save, self._restore, self._release = map(self._function, states)

    def _function(self, name: str) -> Any:
        function = self._library[name]  # a new object at every look-up, so fmpy's own stay as they are
        function.restype = ctypes.c_uint  # a negative status is no success
        return function

    def _addresses(self, set_real: str, do_step: str, get_real: str) -> dict[str, int]:
        """Of these functions, of those of states and of the instance."""
        names = {"set_real": set_real, "do_step": do_step, "get_real": get_real}
        functions = {key: self._library[name] for key, name in names.items()}
        functions |= {"save": self._save, "release": self._release}
        found = {key: ctypes.cast(function, ctypes.c_void_p) for key, function in functions.items()}
        return {key: address.value or 0 for key, address in found.items()} | {
            "component": self._handle.value or 0,
            "in_python": int(self._in_python),
        }

    def _transfer(
        self, function: str, references: Any, *between: Any, values: Vector, after: tuple[Any, ...] = (),
        fail: Callable[[int], None], counted: bool = True,
    ) -> Callable[[], Any]:  # fmt: skip
        """function(instance, references, their number, between, values, after), `between` being arrays.

        It returns the status; `fail` gets one that is worse than a warning. Warnings count if `counted`.
        """
        if not len(references):
            return lambda: OK
        call, handle = self._function(function), self._handle
        wanted, *others, memory = (
            ctypes.c_void_p(array.ctypes.data) for array in (references, *between, values)
        )
        arguments = (handle, wanted, ctypes.c_size_t(len(references)), *others, memory, *after)

        def transfer(kept: Any = (references, between, values)) -> int:  # keeps the memory alive
            status: int = call(*arguments)
            if status:
                if status > WARNING:
                    fail(status)
                self.warned += counted
            return status

        return transfer

    def _bind_typed_getter(
        self, function: str, number: Any, references: Any, size: int, fail: Callable[[int], None],
        after: tuple[Any, ...] = (),
    ) -> tuple[Any, Callable[[], Any]]:  # fmt: skip
        memory = np.zeros(size, number)
        return memory, self._transfer(function, references, values=memory, after=after, fail=fail)

    def save(self, state: ctypes.c_void_p) -> int:
        return self._save(self._handle, ctypes.byref(state))

    def restore(self, state: ctypes.c_void_p) -> int:
        return self._restore(self._handle, state)

    def release(self, state: ctypes.c_void_p) -> int:
        return self._release(self._handle, ctypes.byref(state))
