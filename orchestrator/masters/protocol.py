"""What the run needs of a master."""

from __future__ import annotations

from typing import Protocol

from ..exchange import Exchange


class Master(Protocol):
    """Advances all participants by one macro step."""

    @property
    def degree(self) -> int:
        """Degree of the input signals: 0 held, 1 linear, 2 quadratic."""
        ...

    def step(self, exchange: Exchange, time: float, step: float) -> int:
        """From `time` to `time + step`; returns the number of iterations (1 for explicit masters)."""
        ...
