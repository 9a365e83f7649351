"""What the run needs of a master."""

from __future__ import annotations

from typing import ClassVar, Protocol

from ..engine.exchange import Exchange


class Master(Protocol):
    """Advances all participants by one macro step.

    `implicit`: end values are consistent with the inputs that led to them (a converged iteration).
    """

    implicit: ClassVar[bool]

    @property
    def extrapolation(self) -> str:
        """The name of the input signals, as a scenario has it."""
        ...

    @property
    def degree(self) -> int:
        """Degree of the input signals: 0 held, 1 linear, 2 quadratic, 3 Hermite."""
        ...

    def step(self, exchange: Exchange, time: float, step: float) -> int:
        """From `time` to `time + step`; returns the number of iterations (1 for explicit masters)."""
        ...
