"""FMI 1.0: an instance of an FMU for co-simulation.

It has no initialisation mode: `enter_initialization` initialises it, with the inputs that it has then. Its
state can be neither saved nor restored.
"""

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
from fmpy.fmi1 import FMU1Slave, defaultCallbacks, fmi1CallbackFunctions, fmi1CallbackLoggerTYPE

from .description import BOOLEANS, Description
from .fmi2 import ScalarCalls, pass_message
from .fmi_instance import WARNING, status_name

_LOGGER = fmi1CallbackLoggerTYPE(pass_message)


class Fmi1(ScalarCalls):
    version = "fmi1"
    set_reals, get_reals = "fmi1SetReal", "fmi1GetReal"
    yes = ctypes.c_char(b"\x01")
    interface = FMU1Slave

    def __init__(self, name: str, description: Description, folder: str) -> None:
        super().__init__(name, description, folder)
        self._prefix = f"{description.identifier}_"

    def instantiate(self, log: Callable[[int, bytes], None]) -> None:
        callbacks = fmi1CallbackFunctions()
        callbacks.logger = _LOGGER
        callbacks.stepFinished = None
        self._instantiate(callbacks, defaultCallbacks, log, functions=callbacks)
        self._bind()

    def _function(self, name: str) -> Any:
        return super()._function(self._prefix + name.replace("fmi1", "fmi"))

    def enter_initialization(self, start_time: float, stop_time: float) -> None:
        self._check("fmi1InitializeSlave", ctypes.c_double(start_time), self.yes, ctypes.c_double(stop_time))

    def exit_initialization(self) -> None:
        pass

    def terminate(self) -> None:
        self._check("fmi1TerminateSlave")

    def find_getter(self, kind: str) -> tuple[str, Any]:
        return ("fmi1GetBoolean", np.int8) if kind in BOOLEANS else ("fmi1GetInteger", np.intc)

    def _check(self, name: str, *arguments: Any) -> None:
        """Call a function; an error with its status if it does not succeed."""
        status = self._function(name)(self._handle, *arguments)
        self.warned += status == WARNING
        if status > WARNING:
            error = RuntimeError(f"{name.replace('fmi1', 'fmi')} returned {status_name(status)}")
            error.status = status  # type: ignore[attr-defined]
            raise error
