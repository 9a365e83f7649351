"""The evolving data of a coupled run outside the participants."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np

from models.core.quantities import Vector

from ..participants.protocol import Participant
from .effort import Effort, Sampled
from .signals import History

# Of so many savings, and returns, one is timed.
SELDOM = 8


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
        twin = CouplingState(len(self.values), self.history.rated, self.history.degrees)
        twin.assign(self)
        return twin

    def assign(self, other: CouplingState) -> None:
        """Become equal to `other`, bit for bit."""
        self.arrived[:] = other.arrived
        self.history.put(other.history)
        self.warm_starts = dict(other.warm_starts)

    def snapshot(self) -> dict[str, Any]:
        """Everything as plain numbers and arrays."""
        found: dict[str, Any] = {name: array.copy() for name, array in self._arrays().items()}
        return found | {"known": self.history.count, "warm_starts": dict(self.warm_starts)}

    def resume(self, snapshot: Mapping[str, Any]) -> None:
        """Continue from a snapshot."""
        for name, array in self._arrays().items():
            array[:] = snapshot[name]
        self.history.count = int(snapshot["known"])
        self.warm_starts = dict(snapshot["warm_starts"])

    def _arrays(self) -> dict[str, Any]:
        h = self.history
        past = {"times": h.times, "past_values": h.values, "past_rates": h.rates, "smooth": h.smooth}
        return {"values": self.values, "rates": self.rates} | past


@dataclass(frozen=True)
class SavedPoint:
    """The participants' states by number, and that of the coupling."""

    participants: Mapping[int, Any]
    coupling: CouplingState


class SavedPoints:
    """Saves the present point, once as long as nobody moves."""

    def __init__(self, participants: Sequence[Participant], state: CouplingState, effort: Effort) -> None:
        self._participants, self._state, self._effort = participants, state, effort
        self._saves = self._restores = -1
        self._times = [Sampled() for _ in participants]
        self.present: SavedPoint | None = None  # the saved point at which everybody is

    def save(self) -> SavedPoint:
        """The present point; to be released."""
        if self.present is None:
            states = self._save(range(len(self._participants)))
            self.present = SavedPoint(states, self._state.copy())
        return self.present

    def restore(self, point: SavedPoint) -> None:
        """Back to a saved point, bit for bit."""
        self._restore(point.participants)
        self._state.assign(point.coupling)
        self.present = point

    def release(self, point: SavedPoint) -> None:
        """Free what the participants keep for a point."""
        for i, state in point.participants.items():
            self._participants[i].release(state)
        if self.present is point:
            self.present = None

    @contextmanager
    def keep(self) -> Iterator[SavedPoint]:
        """The present point, saved as long as the block lasts; within another such block at no cost."""
        before, point = self.present, self.save()
        try:
            yield point
        finally:
            if before is None:
                self.release(point)

    @contextmanager
    def rollback(self, part: Sequence[int]) -> Iterator[Callable[[], None]]:
        """Inside the block, a function that returns the participants in `part` to where they are now.

        The state of the coupling is left alone.
        """
        own = {} if self.present else self._save(part)
        states = self.present.participants if self.present else own

        try:
            yield partial(self._restore, {i: states[i] for i in part})
        finally:
            for i, state in own.items():
                self._participants[i].release(state)

    def _save(self, part: Iterable[int]) -> dict[int, Any]:
        self._saves += 1
        return {i: self._call(self._participants[i].save, i, self._saves) for i in part}

    def _restore(self, states: Mapping[int, Any]) -> None:
        self._restores += 1
        for i, state in states.items():
            self._effort.restored[i] += 1
            self._call(partial(self._participants[i].restore, state), i, self._restores)

    def _call(self, call: Callable[[], Any], i: int, number: int) -> Any:
        """What a call of participant i gives; one of SELDOM is timed, for all of them."""
        begin = perf_counter()
        found = call()
        if number % SELDOM == 0:
            self._effort.saving[i] += self._times[i].count(perf_counter() - begin, SELDOM)
        return found
