"""An FMI 2.0 co-simulation FMU as participant, through fmpy's low-level class.

The calls of every step go straight to the FMU's functions with memory that is bound once; fmpy's own
methods build lists at every call.
"""

from __future__ import annotations

import contextlib
import ctypes
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

from models.quantities import Quantity, Vector
from models.system import Instance, suggestion

from ..errors import ParticipantError

STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
DISCARD = 2


class _Reals:
    """A fixed set of Real variables and the memory for their values."""

    def __init__(self, references: Sequence[int], values: Vector | None = None) -> None:
        self.count = len(references)
        self.references = (ctypes.c_uint * self.count)(*references)
        self.values = np.zeros(self.count) if values is None else values
        self.pointer = self.values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


class FmuParticipant:
    """Implements `Participant` for the FMU at `path`, with the parameters and starts of `instance`.

    Inputs follow a polynomial over the step where the FMU offers `<input>_der1`, `_der2`; others are held.
    """

    def __init__(self, name: str, path: Path, instance: Instance) -> None:
        self.name = name
        self._instance = instance
        self._messages: list[str] = []
        self._slave: Any = None
        self._instantiated = False
        try:
            self._description = read_model_description(str(path))
            self._folder = extract(str(path))
        except Exception as error:
            raise ParticipantError(f"{name}: {path} cannot be read as an FMU: {error}") from None
        self._variables = {v.name: v for v in self._description.modelVariables}
        if self._description.coSimulation is None:
            raise ParticipantError(f"{name}: {path} is not a co-simulation FMU")
        self._instantiate()

    def _instantiate(self) -> None:
        self._slave = FMU2Slave(
            guid=self._description.guid,
            unzipDirectory=self._folder,
            modelIdentifier=self._description.coSimulation.modelIdentifier,
            instanceName=self.name,
        )
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(self._log)
        callbacks.allocateMemory = defaultCallbacks.allocateMemory
        callbacks.freeMemory = defaultCallbacks.freeMemory
        with self._naming("instantiate"):
            self._slave.instantiate(callbacks=callbacks, loggingOn=False)
        self._instantiated = True
        dll = self._slave.dll
        self._do_step, self._set_real, self._get_real = dll.fmi2DoStep, dll.fmi2SetReal, dll.fmi2GetReal
        self._state_get, self._state_set = dll.fmi2GetFMUstate, dll.fmi2SetFMUstate
        self._state_free = dll.fmi2FreeFMUstate
        self._handle = self._slave.component

    def _log(self, environment: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        if message:
            self._messages.append(message.decode(errors="replace").strip())

    @contextlib.contextmanager
    def _naming(self, what: str) -> Any:
        """Turn fmpy's exceptions into a message with what the FMU said."""
        try:
            yield
        except ParticipantError:
            raise
        except Exception as error:
            raise ParticipantError(f"{self.name}: {what}: {self._said() or error}") from None

    def _said(self) -> str:
        said = "; ".join(dict.fromkeys(self._messages))
        self._messages.clear()
        return said

    def _require(self, status: int, what: str) -> None:
        if status > 1:
            raise ParticipantError(
                f"{self.name}: {what} returned {STATUS[status]}: {self._said() or 'no message'}"
            )

    def _reference(self, name: str) -> int:
        if name not in self._variables:
            raise ParticipantError(
                f"{self.name}: the FMU has no variable {name!r}; {suggestion(name, self._variables)}"
            )
        return int(self._variables[name].valueReference)

    def connect(
        self, input_names: Sequence[str], inputs: Vector, output_names: Sequence[str], outputs: Vector
    ) -> None:
        self._inputs, self._outputs = inputs, outputs
        references, rows, columns = [], [], []
        for order in range(len(inputs)):
            for column, name in enumerate(input_names):
                full = name if order == 0 else _suffixed(name, f"_der{order}")
                if order == 0 or full in self._variables:
                    references.append(self._reference(full))
                    rows.append(order)
                    columns.append(column)
        self._set = _Reals(references)
        # Where every derivative is taken, the memory is the bound one and nothing needs copying.
        self._whole = len(references) == inputs.size
        if self._whole and inputs.size:
            self._set = _Reals(references, inputs.reshape(-1))
        self._pick = np.array(rows, dtype=np.int64), np.array(columns, dtype=np.int64)
        self._get = _Reals([self._reference(name) for name in output_names], outputs)
        names = self._instance.component.outputs.names
        kinds = [self._variables[n].type if n in self._variables else "" for n in names]
        self._real_outputs = [i for i, kind in enumerate(kinds) if kind == "Real"]
        self._other_outputs = [
            i for i, kind in enumerate(kinds) if kind in ("Boolean", "Integer", "Enumeration")
        ]
        self._get_all = _Reals([self._reference(names[i]) for i in self._real_outputs])

    def initialise(self, start_time: float, stop_time: float) -> None:
        component = self._instance.component
        with self._naming("initialise"):
            self._slave.setupExperiment(startTime=start_time, stopTime=stop_time)
            self._slave.enterInitializationMode()
            for name, value in self._instance.parameters.items():
                self._assign(name, component.parameters.field(name).quantity, value)
            for name, value in self._instance.start.items():
                self._assign(_suffixed(name, "_start"), component.state.field(name).quantity, value)
            for name, value in self._instance.inputs.items():
                self._assign(name, component.inputs.field(name).quantity, value)

    def _assign(self, name: str, quantity: Quantity, value: float) -> None:
        reference = [self._reference(name)]
        kind = self._variables[name].type
        if kind == "Real":
            self._slave.setReal(reference, [float(value)])
        elif kind == "Boolean":
            self._slave.setBoolean(reference, [bool(value)])
        else:
            self._slave.setInteger(reference, [int(value)])

    def finish_initialisation(self) -> None:
        with self._naming("initialise"):
            self._slave.exitInitializationMode()

    def write(self) -> None:
        if not self._set.count:
            return
        if not self._whole:
            self._set.values[:] = self._inputs[self._pick]
        status = self._set_real(self._handle, self._set.references, self._set.count, self._set.pointer)
        if status > 1:
            self._require(status, "setting the inputs")

    def advance(self, time: float, step: float) -> None:
        status = self._do_step(self._handle, time, step, 1)
        if status > 1:
            if status == DISCARD:
                what = f"step from t = {time:.9g} s by {step:g} s was discarded"
                raise ParticipantError(f"{self.name}: {what}: {self._said() or 'no message'}")
            self._require(status, f"step from t = {time:.9g} s by {step:g} s")

    def read(self) -> None:
        status = self._get_real(self._handle, self._get.references, self._get.count, self._get.pointer)
        if status > 1:
            self._require(status, "reading the outputs")

    def read_all(self, values: Vector) -> None:
        reals = self._get_all
        self._require(
            self._get_real(self._handle, reals.references, reals.count, reals.pointer), "reading the outputs"
        )
        values[self._real_outputs] = reals.values
        names = self._instance.component.outputs.names
        with self._naming("reading the outputs"):
            for i in self._other_outputs:
                reference = [self._reference(names[i])]
                boolean = self._variables[names[i]].type == "Boolean"
                get = self._slave.getBoolean if boolean else self._slave.getInteger
                values[i] = float(get(reference)[0])

    def save(self) -> ctypes.c_void_p:
        state = ctypes.c_void_p()
        self._require(self._state_get(self._handle, ctypes.byref(state)), "saving the state")
        return state

    def restore(self, saved: ctypes.c_void_p) -> None:
        self._require(self._state_set(self._handle, saved), "restoring the state")

    def release(self, saved: ctypes.c_void_p) -> None:
        self._require(self._state_free(self._handle, ctypes.byref(saved)), "freeing a saved state")

    def close(self) -> None:
        if self._instantiated:
            self._instantiated = False
            with contextlib.suppress(Exception):
                self._slave.terminate()
            with contextlib.suppress(Exception):
                self._slave.freeInstance()
        shutil.rmtree(getattr(self, "_folder", ""), ignore_errors=True)


def _suffixed(name: str, suffix: str) -> str:
    """`name` with a suffix before its index: position_start, coil_position_start[1]."""
    base, bracket, index = name.partition("[")
    return f"{base}{suffix}{bracket}{index}"
