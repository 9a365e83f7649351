"""A co-simulation FMU of FMI 1.0, 2.0 or 3.0 as participant, and how any FMU is opened in this process."""

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from models.core.quantities import Vector

from ..errors import ParticipantError
from .bound_variables import BoundInputs, BoundOutputs
from .capabilities import list_abilities, signal_degrees, uses_event_mode
from .compiled_calls import SET, STEP, CompiledCalls, NotCompiledError
from .description import Description, DescriptionError, read_description
from .fmi1 import Fmi1
from .fmi2 import Fmi2
from .fmi3 import Fmi3
from .fmi3_events import Fmi3WithEvents
from .opened_fmu import FmuSettings, OpenedFmu
from .protocol import BoundVariables

if TYPE_CHECKING:
    from .model_exchange.integrated import IntegratedFmu


def _open_fmi3(name: str, description: Description, folder: str) -> Fmi3:
    """In event mode if it is used."""
    kind = Fmi3WithEvents if uses_event_mode(description) else Fmi3
    return kind(name, description, folder)


class FmuParticipant(OpenedFmu):
    """Implements `Participant`, `SideChannel` and `Derivatives` for the FMU at `path`.

    Which derivatives of inputs it takes, and which rates it gives, is in `bound_variables`. Inputs that it
    holds over a step get the mean of their signal there, and after it the value at its end. Integers and
    booleans are exchanged as the nearest number.
    """

    instances: ClassVar[Mapping[str, Any]] = {"1.0": Fmi1, "2.0": Fmi2, "3.0": _open_fmi3}

    def __init__(self, name: str, path: Path, settings: FmuSettings, folder: Path | None = None) -> None:
        super().__init__(name, path, settings, folder)
        description = self._fmu.description
        self._records: list[Any] = []
        self._events = self._fmi if isinstance(self._fmi, Fmi3WithEvents) and self._fmi.used else None
        self.has_events = self._events is not None
        self.abilities = list_abilities(description, self)
        self._step = self._fmi.bind_step(self._errors.fail_step)
        holds = 0 in signal_degrees(description, [v.name for v in description.list_variables("input")])
        # What runs in every step are such functions themselves, not methods around them.
        self.advance = self._advance_with_means if holds else self._step

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        return signal_degrees(self._fmu.description, input_names)

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        self._inputs = BoundInputs(self._fmu, bound.input_names, bound.inputs, self._settings.inputs)
        self._outputs = BoundOutputs(self._fmu, bound.output_names, bound.outputs, bound.rates)
        self.write, self.read = self._inputs.write, self._outputs.read
        driven = {bound.input_names[i] for i in self._inputs.picked[1][self._inputs.held]}
        depends = self._fmu.description.depends
        at_once = any(driven.intersection(depends.get(name, driven)) for name in bound.output_names)
        self._ends = bool(driven) and (at_once or bool(bound.rates.size))
        self._all = self._fmu.bind(self._settings.outputs)
        self._all.bind_get(self._errors.fail_to_read)
        return self._outputs.given

    def _advance_with_means(self, time: float, step: float) -> None:
        if self._inputs.held.any():
            self._inputs.write_means(step)
        self._step(time, step)
        if self._ends:
            self._inputs.write_ends(step)

    def compiled_calls(self) -> CompiledCalls:
        inputs, outputs = self._inputs, self._outputs
        if not (inputs.binding.plain and outputs.binding.plain):
            raise NotCompiledError("it exchanges arrays, or values that are not floating-point numbers")
        if inputs.called or outputs.called:
            raise NotCompiledError("it exchanges derivatives by calls of their own")
        if not self._fmi.get_addresses():
            raise NotCompiledError("it is of FMI 1.0, has event mode, or may return early from a step")
        given, taken = inputs.binding.references, outputs.binding.references
        count = len(given)
        # -0.0 leaves every number as it is, also -0.0.
        return CompiledCalls(
            inputs.picked, inputs.held, self._ends, np.ones(count), np.full(count, -0.0), given, taken,
            outputs.rated, self._describe, self._raise_failed, self._errors.check_end, self._find_readable,
        )  # fmt: skip

    def _describe(self, record: Any) -> None:
        """Fill in the addresses (see `compiled`) and keep the record, which counts warnings."""
        self._records.append(record)
        for name, address in self._fmi.get_addresses().items():
            record[name] = address

    def _find_readable(self, names: Sequence[str]) -> Any:
        """The references of these outputs, if one call of compiled code reads them; else None."""
        binding = self._fmu.bind(names)
        return binding.references if binding.plain else None

    def _raise_failed(self, call: int, status: int, time: float, step: float) -> None:
        """Raise the error of a call that compiled code made; not of a step that was made after all."""
        if call == STEP:
            self._errors.fail_step(status, time, step)
            if self._ends:
                self._inputs.write_ends(step)
        elif call == SET:
            self._errors.fail_to_set(status)
        else:
            self._errors.fail_to_read(status)

    def read_all(self, values: Vector) -> None:
        values[:] = self._all.get_values()

    def next_event(self) -> float:
        return (
            self._fmi.next_event() if isinstance(self._fmi, Fmi3WithEvents) and self.has_events else math.inf
        )

    def handle(self, time: float, clocks: Sequence[str]) -> list[str] | None:
        if self._events is None:
            return None
        with self._errors.name_errors(f"event at t = {time:.9g} s"):
            return self._events.handle(time, clocks)

    def get_texts(self, names: Sequence[str]) -> list[str]:
        with self._errors.name_errors("reading texts"):
            return [self._fmi.get_text(self._fmu.find(name)) for name in names]

    def set_texts(self, values: Mapping[str, str]) -> None:
        with self._errors.name_errors("setting texts"):
            for name, text in values.items():
                self._fmi.set_text(self._fmu.find(name), text)

    def get_followed(self) -> Any:
        return self._inputs.follows

    def find_states(self, names: Iterable[str]) -> list[tuple[str, str, float]] | None:
        known, states = self._fmu.description.variables, self._fmu.description.states
        if states is None or not all(name in known and self._fmu.is_real(name) for name in names):
            return None
        return [(state, rate, self._fmu.find(state).nominal) for state, rate in states.items()]

    def jacobian(self, unknown: Sequence[str], known: Sequence[str]) -> Vector:
        of, by = ([self._fmu.find(name) for name in names] for names in (unknown, known))
        with self._errors.name_errors("directional derivatives"):
            columns = [self._fmi.differentiate(of, one) for one in by] if of else []
        return np.array(columns).T.reshape(len(of), len(by))

    def warnings(self) -> tuple[int, str]:
        """How many there were, by status or by message, and the first message."""
        calls = self._fmi.warned + sum(int(record["warned"]) for record in self._records)
        return max(calls, self._errors.warnings), self._errors.first_warning


def open_here(
    name: str, path: Path, settings: FmuSettings, folder: Path | None = None
) -> "FmuParticipant | IntegratedFmu":
    """The FMU at `path` in this process, to be unpacked into `folder`.

    ParticipantError if it cannot be used.
    """
    try:
        about = read_description(path, settings.interface, settings.sizes)
    except DescriptionError as error:
        raise ParticipantError(f"{name}: {path} {error}") from None
    if not about.integrated:
        return FmuParticipant(name, path, settings, folder)
    from .model_exchange.integrated import IntegratedFmu  # with its solver, which takes long to import

    return IntegratedFmu(name, path, settings, folder)
