"""Sweeps over FMUs in one call of compiled code each.

The calls, their order and the numbers are those of `sweeps`, which makes them in Python for any participants.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numba
import numpy as np

from models.compile.array_pointers import ArrayPointers, integers, mark_table, marks, numbers, table

from ..participants.compiled import CALLS, FINE, NOT_FINITE, STEP, CompiledCalls, advance, give, take
from ..participants.held_inputs import at_end, mean
from .signals import gather, interpolate_part

if TYPE_CHECKING:
    from .coupling import Coupling

# An FMU in a sweep: its number, its sources, where its inputs and outputs begin, and its calls.
# The calls come last: numba takes a record that begins with all of another's fields for a subtype of it,
# and would run code that was compiled for the other.
TURN = np.dtype(
    [
        *((name, np.int64) for name in ("number", "first", "last", "first_given", "first_taken", "ends")),
        *CALLS.descr,
    ]
)


class CompiledSweep:
    """A sweep over the participants `order`, which offer `calls`; `sweep` is one of the functions below."""

    def __init__(
        self,
        coupling: Coupling,
        calls: Sequence[CompiledCalls],
        order: Sequence[int],
        sweep: Callable[..., tuple[int, int, int]],
    ) -> None:
        self._coupling, self._order, self._sweep = coupling, order, sweep
        self._calls = calls  # keeps the references alive
        e, h, n = coupling, coupling.state.history, len(coupling.wiring.sources)
        # Where each number that is given lies in the signals, and where among values and rates each number
        # that is taken goes.
        origins, places = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
        for i, one in zip(order, calls, strict=True):
            (rows, columns), own = one.picked, e.wiring.slices[i]
            origins.append(n * rows + e.wiring.columns[i][columns])
            places.append(np.concatenate([np.arange(own.start, own.stop), n + own.start + one.rated]))
        memory = {
            "origins": np.concatenate(origins),
            "held": np.concatenate([np.zeros(0, dtype=np.bool_), *(one.held for one in calls)]),
            "factors": np.concatenate([np.zeros(0), *(one.factors for one in calls)]),
            "offsets": np.concatenate([np.zeros(0), *(one.offsets for one in calls)]),
            "given": np.zeros(sum(map(len, origins))),
            "places": np.concatenate(places),
            "taken": np.zeros(sum(map(len, places))),
        }
        self._memory = ArrayPointers(
            **memory, signals=e.signals, arrived=e.state.arrived, calls=e.calls, times=h.times, past=h.values,
            past_rates=h.rates, rated=h.rated, degrees=h.degrees, smooth=h.smooth, end_smooth=h.end_smooth,
        )  # fmt: skip
        self._turns = np.zeros(len(order), dtype=TURN)
        given = taken = 0
        for turn, i, one in zip(self._turns, order, calls, strict=True):
            turn["number"], turn["first"], turn["last"] = i, e.wiring.slices[i].start, e.wiring.slices[i].stop
            turn["first_given"], turn["first_taken"], turn["ends"] = given, taken, one.ends
            one.bind(turn, memory["given"][given:], memory["taken"][taken:])
            given, taken = given + turn["given_count"], taken + turn["taken_count"]

    def __call__(self, time: float, step: float) -> None:
        if self._coupling.ended and step:
            for one in self._calls:
                one.check_end(time, step)
        known, done = self._coupling.state.history.count, 0
        while True:
            turn, call, status = self._sweep(self._turns, self._memory.record, known, time, step, done)
            if call != STEP:
                break
            self._finish_step(turn, status, time, step)
            done = turn + 1
        if call == NOT_FINITE:
            self._coupling.refuse(slice(0, len(self._coupling.wiring.sources)))
        elif call != FINE:
            self._calls[turn].fail(call, status, time, step)

    def _finish_step(self, turn: int, status: int, time: float, step: float) -> None:
        """Have the participant make the step after all, or raise its error."""
        e, i = self._coupling, self._order[turn]
        gather(e.signals, e.wiring.columns[i], e.inputs[i])
        self._calls[turn].fail(STEP, status, time, step)
        e.ended = True  # it may ask for the end where this step ends, which the others reach too
        e.calls[i] += 1


@numba.njit(cache=True)
def jacobi_sweep(
    turns: Any, memory: Any, known: int, time: float, step: float, done: int
) -> tuple[int, int, int]:
    """As `sweeps.jacobi_sweep`, `done` steps of which are made. The turn, the call and the status that ended
    the sweep; FINE if it is complete."""
    m = memory[0]
    calls = integers(m.calls)
    for i in range(done, len(turns)):
        call, status = _advance(turns[i], m, time, step)
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
def gauss_seidel_sweep(
    turns: Any, memory: Any, known: int, time: float, step: float, done: int
) -> tuple[int, int, int]:
    """As `sweeps.gauss_seidel_sweep`; takes and returns the same as `jacobi_sweep`."""
    m = memory[0]
    calls, signals, arrived = integers(m.calls), table(m.signals), table(m.arrived)
    times, past, past_rates, rated = numbers(m.times), table(m.past), table(m.past_rates), marks(m.rated)
    smooth, end_smooth, degrees = mark_table(m.smooth), marks(m.end_smooth), integers(m.degrees)
    degree, end = signals.shape[0] - 1, time + step
    for i in range(max(0, done - 1), len(turns)):
        turn = turns[i]
        if i >= done:
            call, status = _advance(turn, m, time, step)
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
def propagate(
    turns: Any, memory: Any, known: int, time: float, step: float, done: int
) -> tuple[int, int, int]:
    """As `sweeps.propagate`; takes and returns the same as `jacobi_sweep`."""
    m = memory[0]
    given, origins, arrived = numbers(m.given), integers(m.origins), table(m.arrived)
    factors, offsets = numbers(m.factors), numbers(m.offsets)
    n = arrived.shape[1]
    for i in range(len(turns)):
        turn = turns[i]
        for j in range(turn.first_given, turn.first_given + turn.given_count):
            row = origins[j] // n
            value = arrived[row, origins[j] % n] if row < arrived.shape[0] else 0.0
            given[j] = factors[j] * value + offsets[j]
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
def _advance(turn: Any, m: Any, time: float, step: float) -> tuple[int, int]:
    """Give the FMU its inputs and make the step; the call that did not succeed, or FINE, and its status."""
    given, origins, signals, held = numbers(m.given), integers(m.origins), table(m.signals), marks(m.held)
    factors, offsets = numbers(m.factors), numbers(m.offsets)
    n = signals.shape[1]
    inputs = range(turn.first_given, turn.first_given + turn.given_count)
    for j in inputs:
        row, column = origins[j] // n, origins[j] % n
        value = mean(signals, column, step) if held[j] else signals[row, column]
        given[j] = factors[j] * value + offsets[j]
    call, status = advance(turn, time, step)
    if call == FINE and turn.ends:
        for j in inputs:
            given[j] = factors[j] * at_end(signals, origins[j] // n, origins[j] % n, step) + offsets[j]
        call, status = give(turn)
    return call, status


@numba.njit(cache=True)
def _spread(turn: Any, m: Any) -> bool:
    """Store the FMU's outputs and rates in the coupling; True if all are finite."""
    taken, places, arrived = numbers(m.taken), integers(m.places), table(m.arrived)
    n = arrived.shape[1]
    finite = True
    for j in range(turn.first_taken, turn.first_taken + turn.taken_count):
        finite &= np.isfinite(taken[j])
        arrived[places[j] // n, places[j] % n] = taken[j]
    return finite
