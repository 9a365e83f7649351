"""What the run needs of a way to choose macro steps."""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

from ..exchange import Exchange
from ..masters import Master

# What set the length of a step, by number in result files.
FIXED, ERROR, LONGEST, STOP, EVENT, TIME_EVENT, SHORTEST, CONVERGENCE, DISCARD, GROWTH = range(10)
REASONS = (
    "fixed", "error", "maximum_step", "stop_time", "event", "time_event", "discontinuity", "convergence",
    "discard", "growth",
)  # fmt: skip


class Step(NamedTuple):
    """A macro step that was made, from `end - length` to `end`.

    `iterations` of its last attempt; `rejected` attempts before; `error` estimated, over what is allowed;
    `source` the exchanged value with most of it, or that set the step otherwise, by its number among all
    outputs of the system (-1: none); `reason` what set the length.
    """

    end: float
    length: float
    iterations: int
    rejected: int = 0
    error: float = 0.0
    source: int = -1
    reason: int = FIXED


class Stepper(Protocol):
    """Makes macro steps one after the other. `locates`: it looks for events."""

    @property
    def locates(self) -> bool: ...

    def begin(self, exchange: Exchange, master: Master, start: float, stop: float) -> None:
        """Before the first step."""
        ...

    def step(self, time: float) -> Step:
        """The next step from `time`, accepted into the exchange; RunError where none can be made."""
        ...

    def state(self) -> dict[str, Any]:
        """All that decides the coming steps, as plain numbers."""
        ...

    def resume(self, state: dict[str, Any]) -> None:
        """After `begin`: go on as from that state."""
        ...
