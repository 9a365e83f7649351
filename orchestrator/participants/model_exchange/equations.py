"""The equations of an FMU: x' = f(t, x, u), y = g(t, x, u), event indicators and event mode."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model

from fmus.fmi.model_exchange import EventError, ModelExchange
from models.core.quantities import Vector

from ...errors import EndedError, ParticipantError
from ..description import REALS, Description
from ..fmi2 import Fmi2
from ..fmi3 import Fmi3
from ..opened_fmu import FmuSettings, OpenedFmu


class _Fmi2(Fmi2):
    interface = FMU2Model

    def __init__(self, name: str, description: Description, folder: str) -> None:
        super().__init__(name, _with_library(description), folder)


class _Fmi3(Fmi3):
    interface = FMU3Model

    def __init__(self, name: str, description: Description, folder: str) -> None:
        super().__init__(name, _with_library(description), folder)


def _with_library(description: Description) -> Description:
    assert description.exchange
    return replace(description, identifier=description.exchange.identifier)


class ExchangeFmu(OpenedFmu):
    """The FMU at `path` as equations, whose driven inputs are `inputs`.

    It is initialised, in event mode, or in continuous-time mode. Only in the last do time and states that
    `outputs` is given go to the FMU, and only outside of it inputs that are no continuous numbers.
    """

    instances: ClassVar[Mapping[str, Any]] = {"2.0": _Fmi2, "3.0": _Fmi3}

    def __init__(
        self, name: str, path: Path, settings: FmuSettings, inputs: Sequence[str], folder: Path | None = None
    ) -> None:
        super().__init__(name, path, settings, folder)
        about = self._fmu.description
        if about.exchange is None:
            raise ParticipantError(f"{name}: {path} has no model exchange")
        self.states, self.indicators = about.exchange.states, about.exchange.indicators
        fmi: Any = self._fmi
        self._exchange = ModelExchange(fmi.slave, about.version == "2.0", self.states, self.indicators)
        self._outputs = self._fmu.bind(settings.outputs)
        self._outputs.bind_get(self._errors.fail_to_read)
        self.bind_inputs(inputs)

    def bind_inputs(self, inputs: Sequence[str]) -> None:
        """The driven inputs, in the order of `u`."""
        variables = [self._fmu.find(name) for name in inputs]
        smooth = [v.type in REALS and v.variability in ("", "continuous") for v in variables]
        self._smooth = [i for i, one in enumerate(smooth) if one]
        self._others = [i for i, one in enumerate(smooth) if not one]
        given = self._settings.inputs
        self._smooth_inputs = self._fmu.bind([inputs[i] for i in self._smooth], given)
        self._other_inputs = self._fmu.bind([inputs[i] for i in self._others], given)
        self._smooth_inputs.bind_set(self._errors.fail_to_set)
        self._other_inputs.bind_set(self._errors.fail_to_set)

    def outputs(self, t: float, x: Vector, u: Vector) -> Vector:
        """All outputs; `u` are the driven inputs."""
        self._time = t
        with self._errors.name_errors(f"equations at t = {t:.9g} s"):
            if self._exchange.continuous:
                self._exchange.move(t, x)
            elif self._others:
                self._other_inputs.set_values(u[self._others])
            if self._smooth:
                self._smooth_inputs.set_values(u[self._smooth])
            return self._outputs.get_values()

    def rate(self) -> Vector:
        """The states' derivatives by time, where `outputs` was called last."""
        with self._errors.name_errors("derivatives"):
            return self._exchange.rate()

    def guards(self) -> Vector:
        """The event indicators there, with the signs that they had after the last event."""
        with self._errors.name_errors("event indicators"):
            return self._exchange.guards()

    def enter_events(self) -> None:
        """From continuous-time to event mode."""
        with self._errors.name_errors("event mode"):
            self._exchange.enter_events()

    def iterate(self) -> bool:
        """One event iteration; whether the FMU needs another. EndedError if it ends the simulation."""
        with self._errors.name_errors("event mode"), self._name_end():
            return self._exchange.iterate()

    def leave_events(self) -> float:
        """From event mode to continuous-time mode; the time of the next time event (s), or infinite."""
        with self._errors.name_errors("continuous-time mode"):
            self._exchange.leave_events()
            return self._exchange.next_event

    def complete_step(self) -> bool:
        """An integrator's step ends where `outputs` was called last; whether the FMU asks for event mode."""
        with self._errors.name_errors("end of an integrator's step"), self._name_end():
            return self._exchange.complete_step()

    @contextmanager
    def _name_end(self) -> Iterator[None]:
        try:
            yield
        except EventError:
            raise EndedError(
                f"{self.name}: the FMU asks to end the simulation at t = {self._time:.9g} s; set stop_time "
                "to that, or look at its parameters",
                self._time,
            ) from None

    def get_states(self) -> Vector:
        with self._errors.name_errors("states"):
            return self._exchange.states()

    @property
    def description(self) -> Description:
        """Of the FMU."""
        return self._fmu.description

    @property
    def next_event(self) -> float:
        """The time of the next time event (s), or infinite."""
        return self._exchange.next_event

    def get_event_memory(self) -> tuple[float, Vector]:
        """The next time event and the indicators' signs, which no saved state of the FMU has."""
        return self._exchange.next_event, self._exchange.signs.copy()

    def set_event_memory(self, next_event: float, signs: Vector) -> None:
        """What `get_event_memory` gave."""
        self._exchange.next_event, self._exchange.signs = next_event, signs.copy()

    def get_nominal(self) -> Vector:
        with self._errors.name_errors("nominal sizes of the states"):
            return self._exchange.nominal()
