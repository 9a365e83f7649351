"""FMI 2.0: an instance of an FMU for co-simulation."""

import ctypes
import itertools
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

from models.core.quantities import Vector

from .description import BOOLEANS, Description, Variable
from .fmi_instance import DISCARD, WARNING, Fail, FailStep, FmiInstance, Step, Transfer

try:
    from fmpy.logging import addLoggerProxy as formatting
except Exception:  # not for this platform: messages lack their arguments
    formatting = None

# fmi2StatusKind
LAST_SUCCESSFUL_TIME, TERMINATED = 2, 3
# Receivers of messages, by an instance's environment and by its name: C code that formats messages knows one
# function for all instances.
_listeners: dict[object, Callable[[int, bytes], None]] = {}
_environments = itertools.count(1)


def pass_message(environment: int | None, name: bytes, status: int, category: bytes, message: bytes) -> None:
    """The logger of C: to whoever listens to that instance."""
    listener = _listeners.get(environment) or _listeners.get(name)
    if listener:
        listener(status, message)


def add_formatting(callbacks: ctypes.Structure) -> None:
    """Have C put the arguments of messages in their places before the logger gets them."""
    if formatting:
        formatting(ctypes.byref(callbacks))


def listen(keys: Sequence[object], log: Callable[[int, bytes], None]) -> None:
    """Have `log` get the messages of an instance with one of these environments and names."""
    _listeners.update(dict.fromkeys(keys, log))


def forget_listener(keys: Sequence[object]) -> None:
    """Undo `listen`."""
    for key in keys:
        _listeners.pop(key, None)


_LOGGER = fmi2CallbackLoggerTYPE(pass_message)


class ScalarCalls(FmiInstance):
    """What FMI 1.0 and 2.0 share, whose functions' names begin with `version`; `yes` is their true."""

    real_types = ("Real",)
    version: str
    yes: Any
    formats = True  # whether messages have arguments that C puts in their places
    _heard: tuple[object, ...] = ()

    def _instantiate(
        self, table: Any, memory: Any, log: Callable[[int, bytes], None], *keys: object, **given: Any
    ) -> None:
        """With a table of callbacks, and those of `memory`; `log` gets what is said under name or keys."""
        self._heard = *keys, self.slave.instanceName.encode()
        listen(self._heard, log)
        if self.formats:
            add_formatting(table)
        table.allocateMemory, table.freeMemory = memory.allocateMemory, memory.freeMemory
        try:
            self.slave.instantiate(loggingOn=True, **given)
            if not self.slave.component:
                raise RuntimeError("instantiating gave no instance")
        except BaseException:
            forget_listener(self._heard)
            raise

    def free(self) -> None:
        self.slave.freeInstance()
        forget_listener(self._heard)

    def set(self, variables: Sequence[Variable], values: Iterable[float]) -> None:
        (first, *_), reference = variables, [v.reference for v in variables]
        if first.type == "Real":
            self.slave.setReal(reference, [float(value) for value in values])
        elif first.type in BOOLEANS:
            self.slave.setBoolean(reference, [bool(value) for value in values])
        else:
            self.slave.setInteger(reference, [int(value) for value in values])

    def set_text(self, variable: Variable, text: str) -> None:
        self.slave.setString([variable.reference], [text])

    def get_text(self, variable: Variable) -> str:
        return str(self.slave.getString([variable.reference])[0].decode("utf-8", "replace"))

    def bind_input_derivatives(self, references: Any, orders: Any, values: Vector, fail: Fail) -> Transfer:
        function = f"{self.version}SetRealInputDerivatives"
        return self._transfer(function, references, orders, values=values, fail=fail, counted=False)

    def bind_step(self, fail: FailStep) -> Step:
        call, handle, yes = self._function(f"{self.version}DoStep"), self._handle, self.yes
        begin, duration, ended_in = ctypes.c_double(), ctypes.c_double(), self.ended_in

        def advance(time: float, step: float) -> None:
            if ended_in and time > ended_in.pop():
                return fail(DISCARD, time, step)
            begin.value, duration.value = time, step
            status = call(handle, begin, duration, yes)
            if status:
                if status > WARNING:
                    fail(status, time, step)
                else:
                    self.warned += 1

        return advance

    def get_reached_time(self) -> float | None:
        value = ctypes.c_double()
        status = self._function(f"{self.version}GetRealStatus")(
            self._handle, LAST_SUCCESSFUL_TIME, ctypes.byref(value)
        )
        return value.value if status <= WARNING else None


class Fmi2(ScalarCalls):
    version = "fmi2"
    set_reals, get_reals = "fmi2SetReal", "fmi2GetReal"
    yes = ctypes.c_int(1)
    interface = FMU2Slave

    def __init__(self, name: str, description: Description, folder: str) -> None:
        super().__init__(name, description, folder)
        # Messages of Python FMUs and ours are complete; their percent signs are no formats.
        self.formats = not (description.is_own or Path(folder, "resources", "slavemodule.txt").is_file())

    def instantiate(self, log: Callable[[int, bytes], None]) -> None:
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = _LOGGER
        environment = next(_environments)
        callbacks.componentEnvironment = environment
        self._instantiate(callbacks, defaultCallbacks, log, environment, callbacks=callbacks)
        self._bind("fmi2GetFMUstate", "fmi2SetFMUstate", "fmi2FreeFMUstate")

    def set_up(self, start_time: float, stop_time: float) -> None:
        self.slave.setupExperiment(startTime=start_time, stopTime=stop_time)

    def enter_initialization(self, start_time: float, stop_time: float) -> None:
        self.slave.enterInitializationMode()

    def serialise(self, state: ctypes.c_void_p) -> bytes:
        return bytes(self.slave.serializeFMUstate(state))

    def deserialise(self, data: bytes) -> ctypes.c_void_p:
        state: ctypes.c_void_p = self.slave.deSerializeFMUstate(data)
        return state

    def get_addresses(self) -> dict[str, int]:
        return self._addresses("fmi2DoStep") | {"fmi3": 0, "outcome": 0}

    def find_getter(self, kind: str) -> tuple[str, Any]:
        return "fmi2GetBoolean" if kind in BOOLEANS else "fmi2GetInteger", np.intc

    def bind_output_derivatives(self, references: Any, values: Vector, fail: Fail) -> Transfer:
        orders = np.ones(len(references), dtype=np.intc)
        return self._transfer("fmi2GetRealOutputDerivatives", references, orders, values=values, fail=fail)

    def differentiate(self, unknown: Sequence[Variable], known: Variable) -> list[float]:
        references = [v.reference for v in unknown]
        return list(self.slave.getDirectionalDerivative(references, [known.reference], [1.0]))

    def is_ended(self) -> bool:
        # pythonfmu's C layer says so after every discarded step.
        if self._in_python:
            return False
        value = ctypes.c_int()
        status = self._function("fmi2GetBooleanStatus")(self._handle, TERMINATED, ctypes.byref(value))
        return status <= WARNING and bool(value.value)
