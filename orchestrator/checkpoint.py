"""Checkpoints of a coupled run, and what they need of the loop and of what takes part in it.

Needed of `simulate` (agreed interface; all states are `Plain`, taken between two macro steps):

- `simulate(..., observers, resumed=None)`. Before `begin`, each observer that is a `Keeper` gets
  `attach(snapshot)`. `snapshot()` returns
      {"time", "steps", "rejected", "iterations", "coupled_time_s",   # of the loop
       "step": controller state (next step length, ...), "guard": runaway guard's sums,
       "exchange": exchange.snapshot(),                                 # values, rates, history, ...
       "participants": {name: bytes},                                   # to_bytes(save())
       "observers": [observer.state() for each `Continuing` observer]}
- With `resumed` = such a snapshot: everything is built and initialised as for a new run, then
  `exchange.restore(...)`, participants `restore(from_bytes(...))`, guard, controller and counts are put
  back, observers get `resume(names, state)` (others `begin(names)`), nothing is shown, and the loop goes on
  after "steps". Times are computed of the start time and step numbers as in the run without interruption.
- Order: observers see the step first, `Keeper` comes after those that record and before `Interruption`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

# None, bool, int, float, str, bytes, numpy arrays of numbers, and lists and dicts (by str) of these.
Plain = Any


@runtime_checkable
class Continuing(Protocol):
    """An observer with evolving data of its own."""

    def state(self) -> dict[str, Plain]:
        """The evolving data; files are on the disk up to here."""
        ...

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        """In place of `begin`: go on from `state`, forgetting what came after it."""
        ...


@runtime_checkable
class Keeper(Protocol):
    """An observer that keeps the whole run."""

    def attach(self, snapshot: Callable[[], dict[str, Plain]]) -> None:
        """Before `begin`; `snapshot()` may be called inside `observe`."""
        ...
