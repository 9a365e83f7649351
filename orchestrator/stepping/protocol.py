"""What the run needs of a way to choose macro steps."""

from typing import Any, Protocol

from ..engine.coupling import Coupling
from ..engine.step import Step
from ..masters import Master


class Stepper(Protocol):
    """Makes macro steps one after the other. `locates`: it looks for events."""

    @property
    def locates(self) -> bool: ...

    def begin(self, coupling: Coupling, master: Master, start: float, stop: float) -> None:
        """Before the first step."""
        ...

    def step(self, time: float) -> Step:
        """The next step from `time`, accepted into the coupling; RunError where none can be made."""
        ...

    def state(self) -> dict[str, Any]:
        """All that decides the coming steps, as plain numbers."""
        ...

    def resume(self, state: dict[str, Any]) -> None:
        """After `begin`: go on as from that state."""
        ...
