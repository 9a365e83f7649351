"""An FMU's instance, on fmpy's class for its version of FMI, with fast calls of what runs in every step.

The arguments of these are bound once. ctypes functions without argument types pass them unchanged, while
fmpy's methods build lists at every call.
"""

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from models.core.quantities import Vector

from .description import Description, Variable
from .library import open_library

# Of calls without success; one that FMI does not know, also a negative one, is above WARNING as well.
STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
OK, WARNING, DISCARD, FATAL, PENDING = 0, 1, 2, 4, 5

# Gets the status of a call that did not succeed.
Fail = Callable[[int], None]
# A call whose arguments are bound; it returns the status.
Transfer = Callable[[], Any]
# A step from a time by a length, and what gets the status of one that did not succeed, with these.
Step = Callable[[float, float], None]
FailStep = Callable[[int, float, float], None]


def status_name(status: int) -> str:
    """The name of a status; of an unknown one, its number."""
    known = 0 <= status < len(STATUS)
    return STATUS[status] if known else f"{ctypes.c_int(status).value}, which is no status of FMI"


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


class FmiInstance(ABC):
    """An instance. Calls that do not succeed raise, with the attribute `status`, but for those that return it
    or are given `fail`, which is called with it.

    `interface` is fmpy's class. `real_types` are the types of variables that `set_reals` and `get_reals`
    transfer. `warned` counts calls that returned a warning. `ended_in`: the start (s) of the step at whose
    end the FMU asked to end the simulation, if it did; set by `fail`.
    """

    interface: Any
    real_types: tuple[str, ...]
    set_reals: str
    get_reals: str
    slave: Any

    def __init__(self, name: str, description: Description, folder: str) -> None:
        self.warned = 0
        self.restorable = description.restorable
        self.ended_in: list[float] = []
        self.slave = open_library(self.interface, name, description, folder)
        plain = self.slave._call

        def call(function: str, *arguments: Any) -> Any:
            """What fmpy calls counts warnings, and raises where a status is none."""
            status = plain(function, *arguments)
            if self.slave._functions[function].restype is ctypes.c_int:
                if status < OK:
                    raise RuntimeError(f"{function} returned {status_name(status)}")
                self.warned += status == WARNING
            return status

        self.slave._call = call

    @abstractmethod
    def instantiate(self, log: Callable[[int, bytes], None]) -> None:
        """Make it; `log` gets the status and text of its messages."""

    def configure(self, sizes: Mapping[Variable, int]) -> None:
        """Before all else: set structural parameters."""
        raise self._lacks("structural parameters")

    def set_up(self, start_time: float, stop_time: float) -> None:  # noqa: B027
        """What comes before initialisation and the values that hold for it; nothing, but of FMI 2.0."""

    @abstractmethod
    def enter_initialization(self, start_time: float, stop_time: float) -> None: ...

    def exit_initialization(self) -> None:
        self.slave.exitInitializationMode()

    @abstractmethod
    def set(self, variables: Sequence[Variable], values: Iterable[float]) -> None:
        """Set these scalars: all of one type, or all elements of one array."""

    @abstractmethod
    def set_text(self, variable: Variable, text: str) -> None:
        """Set a string, or a binary value that is given as hexadecimal digits."""

    @abstractmethod
    def get_text(self, variable: Variable) -> str:
        """As `set_text`."""

    def bind_setter(self, references: Any, values: Vector, fail: Fail) -> Transfer:
        """A function that sets the variables of these references (unsigned int) to what is in `values`."""
        return self._transfer(self.set_reals, references, values=values, fail=fail)

    def bind_getter(self, references: Any, values: Vector, fail: Fail) -> Transfer:
        """As `bind_setter`, the other way."""
        return self._transfer(self.get_reals, references, values=values, fail=fail)

    def bind_typed_getter(self, kind: str, references: Any, size: int, fail: Fail) -> tuple[Any, Transfer]:
        """Memory for `size` values of variables of that type, no doubles, and a function that gets them."""
        function, number = self.find_getter(kind)
        memory = np.zeros(size, number)
        return memory, self._transfer(function, references, values=memory, fail=fail)

    @abstractmethod
    def find_getter(self, kind: str) -> tuple[str, Any]:
        """The function that gets variables of that type, and what stores one."""

    def bind_input_derivatives(self, references: Any, orders: Any, values: Vector, fail: Fail) -> Transfer:
        """A function that sets the inputs' derivatives of these orders (int) to what is in `values` and
        returns the status, OK or WARNING; for FMUs that say that they interpolate."""
        raise self._lacks("derivatives of inputs")

    def bind_output_derivatives(self, references: Any, values: Vector, fail: Fail) -> Transfer:
        """A function that gets the first derivatives of outputs by time into `values`, those of arrays whole;
        for FMUs that say that they give them, after initialisation."""
        raise self._lacks("derivatives of outputs")

    def differentiate(self, unknown: Sequence[Variable], known: Variable) -> list[float]:
        """The derivatives of these unknown scalars by a known one; for FMUs that say that they give them."""
        raise self._lacks("directional derivatives")

    @abstractmethod
    def bind_step(self, fail: FailStep) -> Step:
        """A function that steps.

        To ask for the end of the simulation is to discard the step (see `is_ended`), and so is every step
        that begins after the one that it `ended_in`. Where `fail` returns, the step is made.
        """

    @abstractmethod
    def get_reached_time(self) -> float | None:
        """Last successful time after a discarded step, where the FMU says it."""

    def is_ended(self) -> bool:
        """After a discarded step: whether the FMU asks to end the simulation."""
        return False

    def get_addresses(self) -> dict[str, int]:
        """What compiled code needs to call the functions itself (see `compiled`); empty: it cannot."""
        return {}

    def save(self, state: ctypes.c_void_p) -> int:
        return self._save(self._handle, ctypes.byref(state))

    def restore(self, state: ctypes.c_void_p) -> int:
        return self._restore(self._handle, state)

    def release(self, state: ctypes.c_void_p) -> int:
        return self._release(self._handle, ctypes.byref(state))

    def serialise(self, state: ctypes.c_void_p) -> bytes:
        raise self._lacks("serialised states")

    def deserialise(self, data: bytes) -> ctypes.c_void_p:
        raise self._lacks("serialised states")

    def terminate(self) -> None:
        self.slave.terminate()

    @abstractmethod
    def free(self) -> None: ...

    def _lacks(self, call: str) -> NotImplementedError:
        """The error of a call that this version of FMI does not have. Callers ask for abilities first."""
        return NotImplementedError(f"{type(self).__name__} has no {call}")

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

    def _addresses(self, do_step: str) -> dict[str, int]:
        """Of the functions of a step, and of the instance."""
        names = {"set_real": self.set_reals, "do_step": do_step, "get_real": self.get_reals}
        found = {key: ctypes.cast(self._library[name], ctypes.c_void_p) for key, name in names.items()}
        return {key: address.value or 0 for key, address in found.items()} | {
            "component": self._handle.value or 0,
            "in_python": int(self._in_python),
        }

    def _sizes(self, values: Vector) -> tuple[Any, ...]:
        """The arguments of a transfer that follow the memory of the values."""
        return ()

    def _transfer(
        self, function: str, references: Any, *between: Any, values: Vector, fail: Fail, counted: bool = True
    ) -> Transfer:
        """function(instance, references, their number, between, values, sizes), `between` being arrays.

        It returns the status; `fail` gets one that is worse than a warning. Warnings count if `counted`.
        """
        if not len(references):
            return lambda: OK
        call, handle = self._function(function), self._handle
        wanted, *others, memory = (
            ctypes.c_void_p(array.ctypes.data) for array in (references, *between, values)
        )
        arguments = (handle, wanted, ctypes.c_size_t(len(references)), *others, memory, *self._sizes(values))

        def transfer(kept: Any = (references, between, values)) -> int:  # keeps the memory alive
            status: int = call(*arguments)
            if status:
                if status > WARNING:
                    fail(status)
                self.warned += counted
            return status

        return transfer
