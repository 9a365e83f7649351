"""An FMI 2.0 co-simulation FMU as participant, through fmpy's low-level class."""

from __future__ import annotations

import contextlib
import ctypes
import difflib
import shutil
from collections import deque
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

from models.quantities import Layout, Quantity, Vector
from models.system import Instance, suggestion

from ..errors import (
    CannotSerializeError,
    DiscardedStepError,
    LostParticipantError,
    ParticipantError,
    RecoverableError,
    instead_of_discarded,
)
from .compiled import SET, STEP
from .fmi_calls import WARNING, Calls

STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
DISCARD, FATAL = 2, 4

REMEDY = "look at its inputs and parameters, reduce macro_step or use the iterated master"


def missing(path: Path, names: Iterable[str]) -> list[str]:
    """What keeps the FMU at `path` from being a participant with these variables; nothing of it is run."""
    try:
        description = read_model_description(str(path))
    except Exception as error:
        return [f"cannot be read as an FMU: {' '.join(str(error).split())}"]
    if description.coSimulation is None or description.fmiVersion != "2.0":
        return ["is not an FMI 2.0 co-simulation FMU"]
    known = [variable.name for variable in description.modelVariables]
    absent = [name for name in names if name not in known]
    model = f"the FMU of {description.modelName} has no variable"
    return [f"{model} {name!r}{_nearest(name, known)}" for name in absent]


def signal_degrees(path: Path, inputs: Layout) -> dict[str, int]:
    """The degree of the polynomial that the FMU at `path` follows, by input; 0: it holds the value."""
    known = {variable.name for variable in read_model_description(str(path)).modelVariables}

    def degree(name: str) -> int:
        absent = (k for k in range(1, 4) if inputs.field(name).suffixed(f"_der{k}") not in known)
        return next(absent, 4) - 1

    return {name: degree(name) for name in inputs.names}


def _nearest(name: str, known: Sequence[str]) -> str:
    close = difflib.get_close_matches(name, known, n=1)
    return f" (has it {close[0]}?)" if close else ""


class FmuParticipant:
    """Implements `Participant` for the FMU at `path`, with the parameters and starts of `instance`.

    Inputs follow a polynomial over the step where the FMU offers `<input>_der1`, `_der2`; others are held.
    Rates are those of outputs for which the FMU has an output or local variable that it declares to be
    their `derivative`, and of discrete outputs.

    For compiled code that makes the calls of a step itself: the references `given` are set to the inputs
    `picked` (rows, columns); those `taken` are the outputs, then the rates of the outputs `rated`.
    """

    def __init__(self, name: str, path: Path, instance: Instance) -> None:
        self.name = name
        self._instance = instance
        # The last ones: an FMU that says something in every step must not fill the memory.
        self._messages: deque[str] = deque(maxlen=20)
        self._slave: Any = None
        self._instantiated = False
        self._fatal = False
        try:
            self._description = read_model_description(str(path))
            self._folder = extract(str(path))
        except Exception as error:
            raise ParticipantError(f"{name}: {path} cannot be read as an FMU: {error}") from None
        self._variables = {v.name: v for v in self._description.modelVariables}
        if self._description.coSimulation is None:
            raise ParticipantError(f"{name}: {path} is not a co-simulation FMU")
        self.restorable = bool(self._description.coSimulation.canGetAndSetFMUstate)
        try:
            self._instantiate()
        except BaseException:
            self.close()
            raise

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
            self._slave.instantiate(callbacks=callbacks, loggingOn=True)
        self._instantiated = True
        self._calls = Calls(self._slave)
        # What runs in every step are such functions themselves, not methods around them.
        self.advance = self._calls.steps(self._not_advanced)

    def _log(self, environment: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        # Of a Python FMU's traceback the last line says what happened.
        if message and (lines := message.decode(errors="replace").strip().splitlines()):
            self._messages.append(lines[-1])

    @contextlib.contextmanager
    def _naming(self, what: str) -> Any:
        """Turn fmpy's exceptions into a message with what the FMU said."""
        try:
            yield
        except ParticipantError:
            raise
        except Exception as error:
            self._fatal |= getattr(error, "status", None) == FATAL
            kind = LostParticipantError if self._fatal else ParticipantError
            raise kind(f"{self.name}: {what}: {self._said() or error}") from None

    def _said(self) -> str:
        said = "; ".join(dict.fromkeys(self._messages))
        self._messages.clear()
        return said

    def _fail(self, status: int, what: str) -> NoReturn:
        """Raise the error of a call that did not succeed."""
        said = self._said() or "no message"
        message = f"{self.name}: {what} returned {STATUS[status]}: {said}; {REMEDY}"
        if status == FATAL:
            self._fatal = True
            raise LostParticipantError(message)
        raise RecoverableError(message)

    def _discarded(self, time: float, step: float) -> NoReturn:
        """Raise the error of a discarded step, with how far it came."""
        what = f"{self.name}: step from t = {time:.9g} s by {step:g} s returned {STATUS[DISCARD]}"
        said = self._said() or "no message"
        reached = self._calls.reached()
        self._messages.clear()  # what it said about that question
        # A time outside the step says as little as none.
        if reached is not None and not time <= reached < time + step:
            reached = None
        raise DiscardedStepError(
            f"{what}: {said}; look at its inputs and parameters, {instead_of_discarded(self.name)}", reached
        )

    def _reference(self, name: str) -> int:
        if name not in self._variables:
            raise ParticipantError(
                f"{self.name}: the FMU has no variable {name!r}; {suggestion(name, self._variables)}"
            )
        return int(self._variables[name].valueReference)

    def connect(
        self,
        input_names: Sequence[str],
        inputs: Vector,
        output_names: Sequence[str],
        outputs: Vector,
        rates: Vector,
    ) -> Sequence[bool]:
        found, rows, columns = [], [], []
        layout = self._instance.component.inputs
        for order in range(len(inputs)):
            for column, name in enumerate(input_names):
                full = layout.field(name).suffixed(f"_der{order}") if order else name
                if order == 0 or full in self._variables:
                    found.append(self._reference(full))
                    rows.append(order)
                    columns.append(column)
        self._inputs = inputs
        self.given = np.array(found, dtype=np.uintc)
        self.picked = np.array(rows, dtype=np.int64), np.array(columns, dtype=np.int64)
        # Where every derivative is taken, the bound memory is handed over as it is.
        whole = len(found) == inputs.size
        self._picks = inputs if whole else np.zeros(len(found))
        self._set = self._calls.reals("fmi2SetReal", self.given, self._picks, self._setting_failed)
        self.write = self._set if whole else self._write_picked
        self._bind_all_outputs()
        return self._bind_read(output_names, outputs, rates)

    def _bind_read(self, output_names: Sequence[str], outputs: Vector, rates: Vector) -> Sequence[bool]:
        """Bind outputs and rates to one call; for each output, whether its rate is given."""
        wanted = [self._reference(name) for name in output_names]
        companions = self._rates_by_output() if rates.size else {}
        rated = [i for i, name in enumerate(output_names) if name in companions]
        wanted += [companions[output_names[i]] for i in rated]
        self.taken, self.rated = np.array(wanted, dtype=np.uintc), np.array(rated, dtype=np.int64)
        self._outputs, self._rates = outputs, rates
        self._values_and_rates = np.zeros(len(wanted)) if rated else outputs
        self._get = self._calls.reals("fmi2GetReal", self.taken, self._values_and_rates, self._reading_failed)
        self.read = self._read_with_rates if rated else self._get
        if not rates.size:
            return [False] * len(output_names)
        discrete = [self._variables[name].variability == "discrete" for name in output_names]
        rates[discrete] = 0.0
        return [name in companions or still for name, still in zip(output_names, discrete, strict=True)]

    def _rates_by_output(self) -> dict[str, int]:
        """References of the variables that the FMU declares to be derivatives of others, by these."""
        return {
            v.derivative.name: int(v.valueReference)
            for v in self._variables.values()
            if v.derivative is not None and v.type == "Real" and v.causality in ("output", "local")
        }

    def _read_with_rates(self) -> None:
        self._get()
        values, count = self._values_and_rates, self._outputs.size
        self._outputs[:] = values[:count]
        self._rates[self.rated] = values[count:]

    def _bind_all_outputs(self) -> None:
        names = self._instance.component.outputs.names
        kinds = {name: self._variables[name].type for name in names if name in self._variables}
        self._reals = [i for i, name in enumerate(names) if kinds.get(name) == "Real"]
        self._others = [i for i, name in enumerate(names) if kinds.get(name, "Real") != "Real"]
        self._real_values = np.zeros(len(self._reals))
        references = np.array([self._reference(names[i]) for i in self._reals], dtype=np.uintc)
        self._get_all = self._calls.reals("fmi2GetReal", references, self._real_values, self._reading_failed)

    def initialise(self, start_time: float, stop_time: float) -> None:
        component = self._instance.component
        with self._naming("initialise"):
            self._slave.setupExperiment(startTime=start_time, stopTime=stop_time)
            self._slave.enterInitializationMode()
            for name, value in self._instance.parameters.items():
                self._assign(name, component.parameters.field(name).quantity, value)
            for name, value in self._instance.start.items():
                field = component.state.field(name)
                self._assign(field.suffixed("_start"), field.quantity, value)
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

    def _write_picked(self) -> None:
        self._picks[:] = self._inputs[self.picked]
        self._set()

    def _setting_failed(self, status: int) -> None:
        self._fail(status, "setting the inputs")

    def _reading_failed(self, status: int) -> None:
        self._fail(status, "reading the outputs")

    def _not_advanced(self, status: int, time: float, step: float) -> NoReturn:
        if status == DISCARD:
            self._discarded(time, step)
        self._fail(status, f"step from t = {time:.9g} s by {step:g} s")

    def describe(self, record: Any, given: Vector, taken: Vector) -> None:
        """Fill the record (see `compiled`); what is given and taken begins there."""
        for name, address in self._calls.addresses().items():
            record[name] = address
        record["given"], record["taken"] = given.ctypes.data, taken.ctypes.data
        for name, references in (("given", self.given), ("taken", self.taken)):
            record[f"{name}_references"] = references.ctypes.data
            record[f"{name}_count"] = len(references)

    def failed(self, call: int, status: int, time: float, step: float) -> None:
        """Raise the error of a call (see `compiled`) that compiled code made."""
        if call == SET:
            self._setting_failed(status)
        elif call == STEP:
            self._not_advanced(status, time, step)
        else:
            self._reading_failed(status)

    def read_all(self, values: Vector) -> None:
        self._get_all()
        values[self._reals] = self._real_values
        names = self._instance.component.outputs.names
        with self._naming("reading the outputs"):
            for i in self._others:
                boolean = self._variables[names[i]].type == "Boolean"
                get = self._slave.getBoolean if boolean else self._slave.getInteger
                values[i] = float(get([self._reference(names[i])])[0])

    def save(self) -> ctypes.c_void_p:
        if not self.restorable:
            raise ParticipantError(
                f"{self.name}: the FMU cannot save its state (canGetAndSetFMUstate = false); take the master "
                "jacobi or gauss_seidel with steps of fixed length"
            )
        state = ctypes.c_void_p()
        status = self._calls.save(state)
        if status > WARNING:
            self._fail(status, "saving the state")
        return state

    def restore(self, saved: ctypes.c_void_p) -> None:
        status = self._calls.restore(saved)
        if status > WARNING:
            self._fail(status, "restoring the state")

    def to_bytes(self, saved: ctypes.c_void_p) -> bytes:
        if not self._description.coSimulation.canSerializeFMUstate:
            raise CannotSerializeError(
                f"{self.name}: the FMU cannot serialise its state (canSerializeFMUstate = false)"
            )
        with self._naming("serialising the state"):
            return bytes(self._slave.serializeFMUstate(saved))

    def from_bytes(self, data: bytes) -> ctypes.c_void_p:
        with self._naming("taking a serialised state"):
            state: ctypes.c_void_p = self._slave.deSerializeFMUstate(data)
            return state

    def release(self, saved: ctypes.c_void_p) -> None:
        status = self._calls.release(saved)
        if status > WARNING:
            self._fail(status, "freeing a saved state")

    def close(self) -> None:
        # After fmi2Fatal the standard allows no call at all; the instance is given up.
        if self._instantiated and not self._fatal:
            with contextlib.suppress(Exception):
                self._slave.terminate()
            with contextlib.suppress(Exception):
                self._slave.freeInstance()
        self._instantiated = False
        shutil.rmtree(getattr(self, "_folder", ""), ignore_errors=True)
