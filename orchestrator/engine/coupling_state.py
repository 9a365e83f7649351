"""The evolving data of a coupled run outside the participants."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from models.core.quantities import Vector

from .signals import History


class CouplingState:
    """Exchanged values, their rates, their past and warm starts.

    `values` and `rates` are the rows of `arrived`. `warm_starts` has what masters keep for the next macro
    step, plain arrays and numbers. Compiled code has the addresses of the arrays: they are never replaced.
    """

    def __init__(self, size: int, rated: Any, degrees: Any) -> None:
        """Of `size` sources; `rated` and `degrees` as `History` has them."""
        self.arrived: Vector = np.zeros((2, size))
        self.values, self.rates = self.arrived
        self.history = History(0.0, self.values, self.rates, rated)
        self.history.degrees[:] = degrees
        self.warm_starts: dict[str, Any] = {}

    def copy(self) -> CouplingState:
        """An independent copy, between steps."""
        twin = CouplingState.__new__(CouplingState)
        twin.arrived, twin.history = self.arrived.copy(), self.history.copy()
        twin.values, twin.rates = twin.arrived
        twin.warm_starts = dict(self.warm_starts)
        return twin

    def assign(self, other: CouplingState) -> None:
        """Become equal to `other`, bit for bit."""
        self.arrived[:] = other.arrived
        self.history.put(other.history)
        self.warm_starts = dict(other.warm_starts)

    def snapshot(self) -> dict[str, Any]:
        """Everything as plain numbers and arrays."""
        h = self.history
        return {
            "values": self.values.copy(),
            "rates": self.rates.copy(),
            "times": h.times.copy(),
            "past_values": h.values.copy(),
            "past_rates": h.rates.copy(),
            "known": h.count,
            "smooth": h.smooth.copy(),
            "warm_starts": dict(self.warm_starts),
        }

    def resume(self, snapshot: Mapping[str, Any]) -> None:
        """Continue from a snapshot."""
        self.values[:], self.rates[:] = snapshot["values"], snapshot["rates"]
        h = self.history
        h.times[:], h.values[:] = snapshot["times"], snapshot["past_values"]
        h.rates[:], h.smooth[:] = snapshot["past_rates"], snapshot["smooth"]
        h.count = int(snapshot["known"])
        self.warm_starts = dict(snapshot["warm_starts"])
