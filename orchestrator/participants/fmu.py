"""A co-simulation FMU of FMI 2.0 or 3.0 as participant."""

from __future__ import annotations

import contextlib
import ctypes
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import extract

from models.core.quantities import Vector
from models.core.system import suggestion

from ..errors import CannotSerializeError, ParticipantError, RefusedError
from .binding import VariableBinding, find_array
from .bound_calls import ArrayLayout
from .capabilities import name_derivative, signal_degrees
from .compiled import GET, RELEASE, SAVE, SET, STEP, CompiledCalls
from .description import REALS, Variable, read_description
from .failures import ErrorReporter
from .fmi2 import Fmi2
from .fmi3 import Fmi3
from .fmi_instance import DISCARD, WARNING, FmiInstance
from .protocol import BoundVariables

FAILED_CALLS = {
    SET: "setting the inputs",
    GET: "reading the outputs",
    SAVE: "saving the state",
    RELEASE: "freeing a saved state",
}


@dataclass(frozen=True)
class FmuSettings:
    """What an FMU is asked for and given, by the names of its variables: all outputs to be recorded, the
    values of parameters and starts, and of inputs that nothing drives; parameters that are texts."""

    outputs: Sequence[str]
    values: Mapping[str, float] = field(default_factory=dict)
    inputs: Mapping[str, float] = field(default_factory=dict)
    strings: Mapping[str, str] = field(default_factory=dict)


class FmuParticipant(ErrorReporter):
    """Implements `Participant` for the FMU at `path`; `close` deletes where it is unpacked (`folder`).

    Inputs follow a polynomial over the step where the FMU offers `<input>_der1`, `_der2`, or the standard's
    call for derivatives (canInterpolateInputs of FMI 2.0); others are held.
    Whole numbers and truth values are exchanged as the nearest number.
    Rates are those of outputs for which the FMU has an output or local variable that it declares to be
    their `derivative`, or which it gives by the standard's call, and of discrete outputs.

    `follows` says which derivatives of its inputs it makes use of, as `inputs` of `connect` has them.
    """

    def __init__(self, name: str, path: Path, given: FmuSettings, folder: Path | None = None) -> None:
        super().__init__(name)
        self._asked = given
        self._instantiated = self._stepping = False
        self._records: list[Any] = []
        try:
            self._description = read_description(path)
            self._folder = extract(str(path), unzipdir=None if folder is None else str(folder))
        except Exception as error:
            raise ParticipantError(f"{name}: {path} {error}") from None
        self._variables = self._description.variables
        self.restorable = self._description.restorable
        try:
            kind: Any = Fmi3 if self._description.version == "3.0" else Fmi2
            # fmpy goes into the library's folder, and stays there where the library cannot be loaded.
            with contextlib.chdir("."):
                self._fmi: FmiInstance = kind(name, self._description, self._folder)
                self._fmi.instantiate(self._log)
            self._instantiated = True
        except Exception as error:
            self.close()
            raise RefusedError(
                f"{name}: instantiate: {self._quote_message() or error}; {path} cannot be used as it is: "
                "its library may be damaged or not belong to its modelDescription.xml (guid, "
                "instantiationToken), or lack what it needs on this machine; give another file"
            ) from None
        except BaseException:
            self.close()
            raise
        # What runs in every step are such functions themselves, not methods around them.
        self.advance = self._fmi.bind_step(self._not_advanced)

    def _variable(self, name: str) -> Variable:
        if name not in self._variables:
            raise ParticipantError(
                f"{self.name}: the FMU has no variable {name!r}; {suggestion(name, self._variables)}"
            )
        return self._variables[name]

    def _bind_variables(self, names: Iterable[str]) -> VariableBinding:
        return VariableBinding(self._fmi, self._variables, map(self._variable, names))

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        return signal_degrees(self._description, input_names)

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        input_names, inputs, output_names, outputs, rates = bound
        found, rows, columns = [], [], []
        for order in range(len(inputs)):
            for column, name in enumerate(input_names):
                full = name_derivative(name, order) if order else name
                if order == 0 or (full in self._variables and full not in input_names):
                    found.append(self._variable(full))
                    rows.append(order)
                    columns.append(column)
        self._inputs = inputs
        self._picked = np.array(rows, dtype=np.int64), np.array(columns, dtype=np.int64)
        self._set = VariableBinding(self._fmi, self._variables, found, self._asked.inputs)
        # Where every derivative is taken, the bound memory is handed over as it is.
        whole = len(found) == inputs.size and self._set.plain
        self._set.bind_set(self._setting_failed, inputs.ravel() if whole else None)
        self.write = self._set.transfer if whole else self._write_picked
        self._interpolate(input_names, inputs)
        self.follows = np.zeros(inputs.shape, dtype=np.bool_)
        self.follows[self._picked] = True
        self.follows[:, self._interpolated] = True
        self._all = self._bind_variables(self._asked.outputs)
        self._all.bind_get(self._reading_failed)
        rated = self._bind_read(output_names, outputs, rates)
        self._given, self._plain = self._set.references, self._set.plain and self._get.plain
        return rated

    def compiled_calls(self) -> CompiledCalls | str:
        if not self._plain:
            return "it exchanges arrays, or values that are not floating-point numbers"
        if self._interpolated or self._called:
            return "it exchanges derivatives by calls of their own"
        if not self._fmi.get_addresses():
            return "it may return early from a step"
        count = len(self._given)
        # -0.0 leaves every number as it is, also -0.0.
        return CompiledCalls(
            self._picked, np.ones(count), np.full(count, -0.0), self._given, self._taken, self._rated,
            self._describe, self._raise_failed, self.check_end, self._readable,
        )  # fmt: skip

    def _interpolate(self, names: Sequence[str], inputs: Vector) -> None:
        """Have derivatives set by the standard's call for inputs without variables for them."""
        self._interpolated = [
            column
            for column, name in enumerate(names)
            if self._description.interpolates
            and len(inputs) > 1
            and self._variable(name).type in self._fmi.real_types
            and name_derivative(name, 1) not in self._variables
        ]
        if not self._interpolated:
            return
        columns, count = self._interpolated, len(inputs) - 1
        references = np.array([self._variable(names[c]).reference for c in columns] * count, dtype=np.uintc)
        orders = np.repeat(np.arange(1, count + 1, dtype=np.intc), len(columns))
        slopes = np.zeros(len(references))
        send = self._fmi.bind_input_derivatives(references, orders, slopes, self._setting_failed)
        write = self.write

        def write_all() -> None:
            write()
            if self._stepping:  # before that the standard has no such call
                slopes[:] = inputs[1:, columns].ravel()
                send()

        self.write = write_all

    def _bind_read(self, output_names: Sequence[str], outputs: Vector, rates: Vector) -> Sequence[bool]:
        """Bind outputs and rates to one call; for each output, whether its rate is given."""
        wanted = [self._variable(name) for name in output_names]
        companions = self._rates_by_output() if rates.size else {}
        rated = [i for i, name in enumerate(output_names) if name in companions]
        names = [*output_names, *(companions[output_names[i]].name for i in rated)]
        self._get = self._bind_variables(names)
        self._taken, self._rated = self._get.references, np.array(rated, dtype=np.int64)
        self._outputs, self._rates = outputs, rates
        direct = self._get.plain and not rated
        self._get.bind_get(self._reading_failed, outputs if direct else None)
        self.read = self._get.transfer if direct else self._read_with_rates
        self._called: list[int] = []
        if not rates.size:
            return [False] * len(output_names)
        discrete = [v.variability == "discrete" or v.discrete for v in wanted]
        rates[discrete] = 0.0
        given = [name in companions or still for name, still in zip(output_names, discrete, strict=True)]
        self._call_rates([i for i, known in enumerate(given) if not known], wanted)
        return [known or i in self._called for i, known in enumerate(given)]

    def _call_rates(self, lacking: Sequence[int], wanted: Sequence[Variable]) -> None:
        """Have rates of outputs without variables for them got by the standard's call."""
        self._called = [
            i for i in lacking if self._description.gives_rates and wanted[i].type in self._fmi.real_types
        ]
        if not self._called:
            return
        whole = ArrayLayout(wanted[i] for i in self._called)
        references, found = np.array(whole.references, dtype=np.uintc), np.zeros(whole.size)
        get = self._fmi.bind_output_derivatives(references, found, self._reading_failed)
        read = self.read

        def read_called() -> None:
            read()
            if self._stepping:  # before that the standard has no such call
                get()
                self._rates[self._called] = found[whole.places]

        self.read = read_called

    def _rates_by_output(self) -> dict[str, Variable]:
        """The variables that the FMU declares to be derivatives of others, by these."""
        return {
            v.derivative: v
            for v in self._variables.values()
            if v.derivative and v.type in REALS and v.causality in ("output", "local")
        }

    def _read_with_rates(self) -> None:
        values, count = self._get.get_values(), self._outputs.size
        self._outputs[:] = values[:count]
        self._rates[self._rated] = values[count:]

    def initialise(self, start_time: float, stop_time: float) -> None:
        with self._name_errors("initialise"):
            self._fmi.set_up(start_time, stop_time)
            self._assign(self._asked.values)
            for name, text in self._asked.strings.items():
                self._fmi.set_string(self._variable(name), text)
            self._fmi.enter_initialization(start_time, stop_time)
            self._assign(self._asked.inputs)

    def _assign(self, values: Mapping[str, float]) -> None:
        """Set variables by name; of an array that is named in part the other elements start as they do."""
        done: set[tuple[int, str]] = set()
        for name in values:
            variable = self._variable(name)
            if (key := (variable.reference, variable.type)) not in done:
                done.add(key)
                whole = find_array(self._variables, variable)
                self._fmi.set(whole, [values.get(v.name, v.start or 0.0) for v in whole])

    def finish_initialisation(self) -> None:
        with self._name_errors("initialise"):
            self._fmi.exit_initialization()
        self._stepping = True

    def _write_picked(self) -> None:
        self._set.set_values(self._inputs[self._picked])

    def _setting_failed(self, status: int) -> None:
        self._fail(status, "setting the inputs")

    def _reading_failed(self, status: int) -> None:
        self._fail(status, "reading the outputs")

    def _not_advanced(self, status: int, time: float, step: float) -> None:
        if status != DISCARD:
            self._fail(status, f"step from t = {time:.9g} s by {step:g} s")
        self._raise_discarded(time, step)

    def _describe(self, record: Any) -> None:
        """Fill in the addresses (see `compiled`) and keep the record, which counts warnings."""
        self._records.append(record)
        for name, address in self._fmi.get_addresses().items():
            record[name] = address

    def _readable(self, names: Sequence[str]) -> Any:
        """The references of these outputs, if one call of compiled code reads them; else None."""
        binding = self._bind_variables(names)
        return binding.references if binding.plain else None

    def _raise_failed(self, call: int, status: int, time: float, step: float) -> None:
        """Raise the error of a call that compiled code made; not of a step that was made after all."""
        if call == STEP:
            self._not_advanced(status, time, step)
        else:
            self._fail(status, FAILED_CALLS[call])

    def read_all(self, values: Vector) -> None:
        with self._name_errors("reading the outputs"):
            values[:] = self._all.get_values()

    def linearisable(self, names: Iterable[str]) -> bool:
        """Directional derivatives by and of these variables and its states say all about it."""
        found = (self._variables.get(name) for name in names)
        real = (v is not None and v.type in self._fmi.real_types for v in found)
        return self._description.states is not None and all(real)

    @property
    def states(self) -> dict[str, str]:
        """Its continuous states, and their derivatives by time, where it tells."""
        return dict(self._description.states or {})

    def nominal(self, name: str) -> float:
        """A variable's nominal size."""
        return self._variable(name).nominal

    def jacobian(self, unknown: Sequence[str], known: Sequence[str]) -> Vector:
        """d unknown / d known (rows x columns), at the present point, by directional derivatives."""
        of, by = ([self._variable(name) for name in names] for names in (unknown, known))
        with self._name_errors("directional derivatives"):
            columns = [self._fmi.differentiate(of, one) for one in by] if of else []
        return np.array(columns).T.reshape(len(of), len(by))

    def save(self) -> ctypes.c_void_p:
        if not self.restorable:
            raise ParticipantError(
                f"{self.name}: the FMU cannot save its state (canGetAndSetFMUstate = false); take the master "
                "jacobi or gauss_seidel with steps of fixed length"
            )
        state = ctypes.c_void_p()
        status = self._fmi.save(state)
        if status > WARNING:
            self._fail(status, "saving the state")
        return state

    def restore(self, saved: ctypes.c_void_p) -> None:
        status = self._fmi.restore(saved)
        if status > WARNING:
            self._fail(status, "restoring the state")

    def to_bytes(self, saved: ctypes.c_void_p) -> bytes:
        if not self._description.serialisable:
            raise CannotSerializeError(
                f"{self.name}: the FMU cannot serialise its state (canSerializeFMUstate = false)"
            )
        with self._name_errors("serialising the state"):
            return self._fmi.serialise(saved)

    def from_bytes(self, data: bytes) -> ctypes.c_void_p:
        with self._name_errors("taking a serialised state"):
            return self._fmi.deserialise(data)

    def release(self, saved: ctypes.c_void_p) -> None:
        status = self._fmi.release(saved)
        if status > WARNING:
            self._fail(status, "freeing a saved state")

    def warnings(self) -> tuple[int, str]:
        """How many there were, by status or by message, and the first message."""
        steps = self._fmi.warned + sum(int(record["warned"]) for record in self._records)
        return max(steps, self._warnings), self._first_warning

    def close(self) -> None:
        # After fmi2Fatal the standard allows no call at all; the instance is given up.
        if self._instantiated and not self._fatal:
            with contextlib.suppress(Exception):
                self._fmi.terminate()
            with contextlib.suppress(Exception):
                self._fmi.free()
        self._instantiated = False
        shutil.rmtree(getattr(self, "_folder", ""), ignore_errors=True)
