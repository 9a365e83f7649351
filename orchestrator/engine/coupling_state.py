"""What evolves in a coupled run outside the participants."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from models.core.quantities import Vector

from .signals import History


class CouplingState:
    """Exchanged values, their rates and past, and what masters carry from step to step.

    `values` and `rates` are the rows of `arrived`. `carried` has plain arrays and numbers only. Compiled code
    has the addresses of the arrays: states are assigned, never replaced.
    """

    def __init__(self, size: int, rated: Any, degrees: Any) -> None:
        """Of `size` sources; `rated` and `degrees` as `History` has them."""
        self.arrived: Vector = np.zeros((2, size))
        self.values, self.rates = self.arrived
        self.history = History(0.0, self.values, self.rates, rated)
        self.history.degrees[:] = degrees
        self.carried: dict[str, Any] = {}

    def copy(self) -> CouplingState:
        """An independent copy, between steps."""
        twin = CouplingState.__new__(CouplingState)
        twin.arrived, twin.history = self.arrived.copy(), self.history.copy()
        twin.values, twin.rates = twin.arrived
        twin.carried = dict(self.carried)
        return twin

    def assign(self, other: CouplingState) -> None:
        """Become equal to `other`, bit for bit."""
        self.arrived[:] = other.arrived
        self.history.put(other.history)
        self.carried = dict(other.carried)

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
            "carried": dict(self.carried),
        }

    def resume(self, snapshot: Mapping[str, Any]) -> None:
        """Continue from a snapshot."""
        self.values[:], self.rates[:] = snapshot["values"], snapshot["rates"]
        h = self.history
        h.times[:], h.values[:] = snapshot["times"], snapshot["past_values"]
        h.rates[:], h.smooth[:] = snapshot["past_rates"], snapshot["smooth"]
        h.count = int(snapshot["known"])
        self.carried = dict(snapshot["carried"])
