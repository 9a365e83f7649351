"""Passes over FMUs alone, each in one call of compiled code.

The calls, their order and the numbers are those of `passes`, which does the same in Python for any
participants.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numba
import numpy as np

from models.compile.array_pointers import ArrayPointers, integers, mark_table, marks, numbers, table

from ..participants.compiled import CALLS, FINE, NOT_FINITE, STEP, advance, give, take
from .signals import interpolate_part

if TYPE_CHECKING:
    from ..participants.fmu import FmuParticipant
    from .exchange import Exchange

# An FMU in a sweep: its number, its sources, where its inputs and outputs begin, and its calls.
# The calls come last: numba takes a record that begins with all of another's fields for a subtype of it,
# and would run code that was compiled for the other.
TURN = np.dtype(
    [*((name, np.int64) for name in ("number", "first", "last", "first_given", "first_taken")), *CALLS.descr]
)


class FmuPass:
    """A pass over `fmus`, participants `order`, by compiled code: `sweep` is one of those below."""

    def __init__(
        self,
        exchange: Exchange,
        fmus: Sequence[FmuParticipant],
        order: Sequence[int],
        sweep: Callable[..., tuple[int, int, int]],
    ) -> None:
        self._exchange, self._fmus, self._sweep = exchange, fmus, sweep
        e, h, n = exchange, exchange.history, len(exchange.sources)
        # Where each number that is given lies in the signals, and each that is taken goes to among values and
        # rates.
        origins, places = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
        for i, fmu in zip(order, fmus, strict=True):
            (rows, columns), own = fmu.picked, e.slices[i]
            origins.append(n * rows + e.columns[i][columns])
            places.append(np.concatenate([np.arange(own.start, own.stop), n + own.start + fmu.rated]))
        memory = {
            "origins": np.concatenate(origins),
            "given": np.zeros(sum(map(len, origins))),
            "places": np.concatenate(places),
            "taken": np.zeros(sum(map(len, places))),
        }
        self._memory = ArrayPointers(
            **memory, signals=e.signals, arrived=e.arrived, calls=e.calls, times=h.times, past=h.values,
            past_rates=h.rates, rated=h.rated, degrees=h.degrees, smooth=h.smooth, end_smooth=h.end_smooth,
        )  # fmt: skip
        self._references = [(fmu.given, fmu.taken) for fmu in fmus]  # kept, as the memory: addresses do not
        self._turns = np.zeros(len(order), dtype=TURN)
        given = taken = 0
        for turn, i, fmu in zip(self._turns, order, fmus, strict=True):
            turn["number"], turn["first"], turn["last"] = i, e.slices[i].start, e.slices[i].stop
            turn["first_given"], turn["first_taken"] = given, taken
            fmu.fill_record(turn, memory["given"][given:], memory["taken"][taken:])
            given, taken = given + turn["given_count"], taken + turn["taken_count"]

    def __call__(self, time: float, step: float) -> None:
        if self._exchange.ended and step:
            for fmu in self._fmus:
                fmu.check_end(time, step)
        known, done = self._exchange.history.count, 0
        while True:
            turn, call, status = self._sweep(self._turns, self._memory.record, known, time, step, done)
            if call != STEP:
                break
            self._fmus[turn].raise_error(call, status, time, step)
            # It asks for the end at that of its step, which the others make too.
            self._exchange.ended = True
            self._exchange.calls[self._turns[turn]["number"]] += 1
            done = turn + 1
        if call == NOT_FINITE:
            self._exchange.refuse(slice(0, len(self._exchange.sources)))
        elif call != FINE:
            self._fmus[turn].raise_error(call, status, time, step)


@numba.njit(cache=True)
def together(
    turns: Any, memory: Any, known: int, time: float, step: float, done: int
) -> tuple[int, int, int]:
    """As `passes.together`, of which `done` steps are made already. The turn, the call and the status that
    ended the pass; FINE where none did."""
    m = memory[0]
    calls = integers(m.calls)
    for i in range(done, len(turns)):
        _give(turns[i], m)
        call, status = advance(turns[i], time, step)
        if call != FINE:
            return i, call, status
        calls[turns[i].number] += 1
    for i in range(len(turns)):
        call, status = take(turns[i])
        if call != FINE:
            return i, call, status
    finite = True
    for i in range(len(turns)):
        finite &= _spread(turns[i], m)
    return 0, (FINE if finite else NOT_FINITE), 0


@numba.njit(cache=True)
def in_turn(turns: Any, memory: Any, known: int, time: float, step: float, done: int) -> tuple[int, int, int]:
    """As `passes.in_turn`; takes and returns the same as `together`."""
    m = memory[0]
    calls, signals, arrived = integers(m.calls), table(m.signals), table(m.arrived)
    times, past, past_rates, rated = numbers(m.times), table(m.past), table(m.past_rates), marks(m.rated)
    smooth, end_smooth, degrees = mark_table(m.smooth), marks(m.end_smooth), integers(m.degrees)
    degree, end = signals.shape[0] - 1, time + step
    for i in range(max(0, done - 1), len(turns)):
        turn = turns[i]
        if i >= done:
            _give(turn, m)
            call, status = advance(turn, time, step)
            if call != FINE:
                return i, call, status
            calls[turn.number] += 1
        call, status = take(turn)
        if call != FINE:
            return i, call, status
        if not _spread(turn, m):
            return i, NOT_FINITE, 0
        interpolate_part(
            times, past, past_rates, rated, degrees, smooth, end_smooth, known, degree, end, arrived[0],
            arrived[1], signals, turn.first, turn.last,
        )  # fmt: skip
    return 0, FINE, 0


@numba.njit(cache=True)
def settled(turns: Any, memory: Any, known: int, time: float, step: float, done: int) -> tuple[int, int, int]:
    """As `passes.settled`; returns the same as `together`."""
    m = memory[0]
    given, origins, arrived = numbers(m.given), integers(m.origins), table(m.arrived)
    n = arrived.shape[1]
    for i in range(len(turns)):
        turn = turns[i]
        for j in range(turn.first_given, turn.first_given + turn.given_count):
            row = origins[j] // n
            given[j] = arrived[row, origins[j] % n] if row < arrived.shape[0] else 0.0
        call, status = give(turn)
        if call != FINE:
            return i, call, status
        call, status = take(turn)
        if call != FINE:
            return i, call, status
        if not _spread(turn, m):
            return i, NOT_FINITE, 0
    return 0, FINE, 0


@numba.njit(cache=True)
def _give(turn: Any, m: Any) -> None:
    """Put what the FMU is given in its place."""
    given, origins, signals = numbers(m.given), integers(m.origins), table(m.signals)
    n = signals.shape[1]
    for j in range(turn.first_given, turn.first_given + turn.given_count):
        given[j] = signals[origins[j] // n, origins[j] % n]


@numba.njit(cache=True)
def _spread(turn: Any, m: Any) -> bool:
    """Put what was taken from the FMU in its place; True if it is finite."""
    taken, places, arrived = numbers(m.taken), integers(m.places), table(m.arrived)
    n = arrived.shape[1]
    finite = True
    for j in range(turn.first_taken, turn.first_taken + turn.taken_count):
        finite &= np.isfinite(taken[j])
        arrived[places[j] // n, places[j] % n] = taken[j]
    return finite
