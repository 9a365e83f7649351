"""What a co-simulation FMU has at communication points besides numbers: events, clocks and texts."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from .bound_variables import OpenFmu
from .description import Description
from .fmi3_events import Fmi3WithEvents


def has_side_channel(about: Description) -> bool:
    """Whether a co-simulation FMU of this description has one."""
    return not about.integrated and (uses_event_mode(about) or bool(about.list_texts("input", "output")))


def uses_event_mode(about: Description) -> bool:
    """Whether an FMU is run in its event mode. Those of our components do the same without."""
    return about.events is not None and not about.is_own


class FmuSideChannel:
    """Implements `SideChannel` for an FMU in this process."""

    def __init__(self, fmu: OpenFmu) -> None:
        self._fmu = fmu
        self._events = fmu.fmi if isinstance(fmu.fmi, Fmi3WithEvents) and fmu.fmi.used else None
        self.has_events = self._events is not None

    def next_event(self) -> float:
        return self._events.next_event() if self._events else float("inf")

    def handle(self, time: float, clocks: Sequence[str]) -> list[str] | None:
        if self._events is None:
            return None
        with self._fmu.errors.name_errors(f"event at t = {time:.9g} s"):
            return self._events.handle(time, clocks)

    def get_texts(self, names: Sequence[str]) -> list[str]:
        with self._fmu.errors.name_errors("reading texts"):
            return [self._fmu.fmi.get_text(self._fmu.find(name)) for name in names]

    def set_texts(self, values: Mapping[str, str]) -> None:
        with self._fmu.errors.name_errors("setting texts"):
            for name, text in values.items():
                self._fmu.fmi.set_text(self._fmu.find(name), text)


class RemoteSideChannel:
    """Implements `SideChannel` for an FMU in its own process, by `call`."""

    def __init__(self, about: Description, call: Callable[..., Any]) -> None:
        self._call = call
        self.has_events = uses_event_mode(about)

    def next_event(self) -> float:
        return float(self._call("next_event"))

    def handle(self, time: float, clocks: Sequence[str]) -> list[str] | None:
        found: list[str] | None = self._call("handle", time=time, clocks=list(clocks))
        return found

    def get_texts(self, names: Sequence[str]) -> list[str]:
        return list(self._call("get_texts", names=list(names)))

    def set_texts(self, values: Mapping[str, str]) -> None:
        self._call("set_texts", values=dict(values))
