"""FMI 1.0: an instance of an FMU for co-simulation.

It has no initialisation mode: `enter_initialization` initialises it, with the inputs that it has then. Its
state can be neither saved nor restored.
"""

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from fmpy.fmi1 import FMU1Slave, defaultCallbacks, fmi1CallbackFunctions, fmi1CallbackLoggerTYPE

from models.core.quantities import Vector

from .description import BOOLEANS, Description, Variable
from .fmi2 import ScalarCalls, pass_message
from .fmi_instance import DISCARD, WARNING, status_name

_LOGGER = fmi1CallbackLoggerTYPE(pass_message)


class Fmi1(ScalarCalls):
    """Implements `FmiInstance`."""

    version = "fmi1"
    interface: Any = FMU1Slave

    def __init__(self, name: str, description: Description, folder: str) -> None:
        self._open(self.interface, name, description, folder)
        self._prefix = f"{description.identifier}_"
        self._interpolates = description.interpolates
        self.ended_in: list[float] = []

    def instantiate(self, log: Callable[[int, bytes], None]) -> None:
        callbacks = fmi1CallbackFunctions()
        callbacks.logger = _LOGGER
        callbacks.stepFinished = None
        self._instantiate(callbacks, defaultCallbacks, log, functions=callbacks)
        self._bind()

    def _function(self, name: str) -> Any:
        return super()._function(self._prefix + name.replace("fmi1", "fmi"))

    def set_up(self, start_time: float, stop_time: float) -> None:
        pass

    def enter_initialization(self, start_time: float, stop_time: float) -> None:
        arguments = ctypes.c_double(start_time), ctypes.c_char(b"\x01"), ctypes.c_double(stop_time)
        self._check("fmi1InitializeSlave", *arguments)

    def exit_initialization(self) -> None:
        pass

    def terminate(self) -> None:
        self._check("fmi1TerminateSlave")

    def get_addresses(self) -> dict[str, int]:
        return {}

    def bind_typed_getter(
        self, kind: str, references: Any, size: int, fail: Callable[[int], None]
    ) -> tuple[Any, Callable[[], None]]:
        name, number = ("Boolean", np.int8) if kind in BOOLEANS else ("Integer", np.intc)
        return self._bind_typed_getter(f"fmi1Get{name}", number, references, size, fail)

    def bind_output_derivatives(
        self, references: Any, values: Vector, fail: Callable[[int], None]
    ) -> Callable[[], None]:
        raise NotImplementedError("rates are not taken from FMUs of FMI 1.0")

    def differentiate(self, unknown: Sequence[Variable], known: Variable) -> list[float]:
        raise NotImplementedError("FMI 1.0 has no directional derivatives")

    def bind_step(self, fail: Callable[[int, float, float], None]) -> Callable[[float, float], None]:
        call, handle, new = self._function("fmi1DoStep"), self._handle, ctypes.c_char(b"\x01")

        def advance(time: float, step: float) -> None:
            status = call(handle, ctypes.c_double(time), ctypes.c_double(step), new)
            if status:
                if status > WARNING:
                    fail(status, time, step)
                else:
                    self.warned += 1

        return advance

    def is_ended(self) -> bool:
        return False

    def save(self, state: ctypes.c_void_p) -> int:
        return DISCARD

    def restore(self, state: ctypes.c_void_p) -> int:
        return DISCARD

    def release(self, state: ctypes.c_void_p) -> int:
        return DISCARD

    def serialise(self, state: ctypes.c_void_p) -> bytes:
        raise NotImplementedError("FMI 1.0 has no states to save")

    def deserialise(self, data: bytes) -> ctypes.c_void_p:
        raise NotImplementedError("FMI 1.0 has no states to save")

    def _check(self, name: str, *arguments: Any) -> None:
        """Call a function; an error with its status if it does not succeed."""
        status = self._function(name)(self._handle, *arguments)
        self.warned += status == WARNING
        if status > WARNING:
            error = RuntimeError(f"{name.replace('fmi1', 'fmi')} returned {status_name(status)}")
            error.status = status  # type: ignore[attr-defined]
            raise error
