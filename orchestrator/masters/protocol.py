"""What the run needs of a master."""

from __future__ import annotations

from typing import Protocol

from ..exchange import Exchange
from ..signals import DEGREES


class Master(Protocol):
    """Advances all participants by one macro step."""

    def step(self, exchange: Exchange, time: float, step: float) -> int:
        """From `time` to `time + step`; returns the number of iterations (1 for explicit masters)."""
        ...


def degree_of(name: str) -> int:
    """The degree of an input signal by name; ValueError with the known names."""
    if name not in DEGREES:
        raise ValueError(f"extrapolation = {name!r}: must be one of {', '.join(DEGREES)}")
    return DEGREES[name]
