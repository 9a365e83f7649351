"""Names an unstable explicit coupling before it ends in numbers that are not finite."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from models.array_pointers import ArrayPointers

from ..errors import UnstableCouplingError
from ..exchange import Exchange
from ..masters import Master, name_of
from ..signals import judge


class RunawayGuard:
    """It judges the exchanged values, which the master reads in every step.

    An explicit master is right only where exchanged values follow their own prediction. Where they swing
    with the macro step itself, or a contact bounces within single steps, the sum of what they miss their
    linear extrapolation by, over the last WINDOW steps or so, is as large as the values themselves (or
    their nominal sizes, if those are larger): more than SHARE of it is a runaway. An impact misses in one
    or two steps of a window and passes. Any master: a value of BOUND nominal sizes is a runaway.
    """

    WINDOW = 50
    FIRST = 10  # steps that are not judged: a start in motion rings
    SHARE = 0.5
    BOUND = 1e9

    def __init__(self, exchange: Exchange, master: Master) -> None:
        self._exchange = exchange
        self._master = master
        self._missed = np.zeros(len(exchange.sources))
        self._size = np.zeros(len(exchange.sources))
        # Only what is exchanged is judged.
        self._nominal = np.full(len(exchange.sources), np.inf)
        self._nominal[exchange.connected] = exchange.nominal[exchange.connected]
        self._patience = math.inf if master.implicit else float(self.FIRST)
        self._keep = 1.0 - 1.0 / self.WINDOW
        past = exchange.history
        self._memory = ArrayPointers(
            times=past.times, values=past.values, new=exchange.values, nominal=self._nominal,
            missed=self._missed, sizes=self._size,
        )  # fmt: skip

    def judge(self, time: float, step: float) -> None:
        """UnstableCouplingError if the values after `step` at `time` run away."""
        self._patience -= 1
        share = self.SHARE if self._patience < 0 else math.inf
        known = self._exchange.history.count
        worst = judge(self._memory.record, known, time, self._keep, self.BOUND, share)
        if worst >= 0:
            source = self._exchange.sources[worst]
            other = "another extrapolation" if self._master.implicit else "the iterated master"
            raise UnstableCouplingError(
                f"{source}: unstable coupling at t = {time:.6g} s: its values do not follow their "
                f"own prediction any more; {name_of(self._master)} cannot couple this system with steps "
                f"of {step:g} s: reduce macro_step, use [step_control], or {other}"
            )

    def state(self) -> dict[str, Any]:
        """The sums, as plain arrays."""
        return {"missed": self._missed.copy(), "size": self._size.copy(), "patience": self._patience}

    def resume(self, state: dict[str, Any]) -> None:
        self._missed[:], self._size[:] = state["missed"], state["size"]
        self._patience = float(state["patience"])
