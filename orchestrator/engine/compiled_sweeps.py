"""Sweeps over FMUs in one call of compiled code each.

The calls, their order and the numbers are those of sweeps in Python (see `sweeps`).
"""

from collections.abc import Sequence
from time import perf_counter
from typing import Any

import numpy as np

from models.compile.array_pointers import ArrayPointers, integers, marks, numbers, table
from models.compile.compiled import compiled

from ..participants import held_inputs
from ..participants.compiled import advance, give, take
from ..participants.compiled_calls import CALLS, FINE, NOT_FINITE, STEP, CompiledCalls
from .effort import Sampled
from .exchange import Exchange
from .signals import gather, interpolate_part

# Of so many sweeps one is timed; at the beginning more, at intervals that grow by this factor.
SELDOM, GROWTH = 127, 1.2

mean, at_end = compiled(held_inputs.mean), compiled(held_inputs.at_end)

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
    """A sweep over the participants `order`, which offer `calls`; `steps` and `in_turn` as of its kind."""

    def __init__(
        self, e: Exchange, calls: Sequence[CompiledCalls], order: Sequence[int], steps: bool, in_turn: bool
    ) -> None:
        self._exchange, self._order, self._kind = e, order, (steps, in_turn)
        self._left, self._weight = 1, 0  # the first sweep compiles or loads code, and is not timed
        self._calls = calls  # keeps the references alive
        self._times = [Sampled() for _ in order]
        n = len(e.wiring.sources)
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
        self._memory = ArrayPointers(**memory, signals=e.signals, arrived=e.state.arrived, counts=e.calls)
        self._turns = np.zeros(len(order), dtype=TURN)
        given = taken = 0
        for turn, i, one in zip(self._turns, order, calls, strict=True):
            turn["number"], turn["first"], turn["last"] = i, e.wiring.slices[i].start, e.wiring.slices[i].stop
            turn["first_given"], turn["first_taken"], turn["ends"] = given, taken, one.ends
            one.bind(turn, memory["given"][given:], memory["taken"][taken:])
            given, taken = given + turn["given_count"], taken + turn["taken_count"]

    def __call__(self, time: float, step: float) -> None:
        if self._exchange.ended and step:
            for one in self._calls:
                one.check_end(time, step)
        if self._left:
            self._left -= 1
            self._run(self._turns, 0, time, step)
            return
        weight = self._weight + 1
        self._left = self._weight = min(int(GROWTH * weight), SELDOM - 1)
        self._time(time, step, weight)

    def _time(self, time: float, step: float, weight: int) -> None:
        """One participant after the other, each timed for `weight` sweeps: with the same numbers."""
        spent = self._exchange.effort.stepping
        begin = perf_counter()
        self._run(self._turns[:0], 0, time, step)
        end = perf_counter()
        calling = end - begin  # compiled code
        for k, i in enumerate(self._order):
            begin = end
            self._run(self._turns[k : k + 1], k, time, step)
            end = perf_counter()
            spent[i] += self._times[k].count(max(0.0, end - begin - calling), weight)

    def _run(self, turns: Any, first: int, time: float, step: float) -> None:
        """These turns, of which `first` is the number of the first."""
        e, history = self._exchange, self._exchange.state.history
        done = 0
        while True:
            turn, call, status = _sweep(
                turns, self._memory.record, history.memory, history.count, *self._kind, time, step, done
            )
            if call != STEP:
                break
            self._finish_step(first + turn, status, time, step)
            done = turn + 1
        if call == NOT_FINITE:
            e.refuse(slice(0, len(e.wiring.sources)))
        elif call != FINE:
            self._calls[first + turn].fail(call, status, time, step)

    def _finish_step(self, turn: int, status: int, time: float, step: float) -> None:
        """Have the participant make the step after all, or raise its error."""
        e, i = self._exchange, self._order[turn]
        gather(e.signals, *e.locate_inputs([i]), e.all_inputs)
        self._calls[turn].fail(STEP, status, time, step)
        e.ended = True  # it may ask for the end where this step ends, which the others reach too
        e.calls[i] += 1


@compiled
def _sweep(
    turns: Any, memory: Any, history: Any, known: int, steps: bool, in_turn: bool, time: float, step: float,
    done: int,
) -> tuple[int, int, int]:  # fmt: skip
    """A sweep of which `done` steps are made. The turn, the call and the status that ended it; FINE if it is
    complete."""
    m = memory[0]
    counts, signals, arrived = integers(m.counts), table(m.signals), table(m.arrived)
    for i in range(max(0, done - 1), len(turns)):
        turn = turns[i]
        if i >= done:
            if steps:
                call, status = _advance(turn, m, time, step)
            else:
                call, status = _give_present(turn, m)
            if call != FINE:
                return i, call, status
            counts[turn.number] += steps
        if in_turn:
            call, status = _read(turn, m)
            if call != FINE:
                return i, call, status
            if steps:
                interpolate_part(
                    history, known, signals.shape[0] - 1, time + step, arrived[0], arrived[1], signals,
                    turn.first, turn.last,
                )  # fmt: skip
    ended = FINE
    if not in_turn:
        for i in range(len(turns)):
            call, status = _read(turns[i], m)
            if call == NOT_FINITE:
                ended = NOT_FINITE
            elif call != FINE:
                return i, call, status
    return 0, ended, 0


@compiled
def _give_present(turn: Any, m: Any) -> tuple[int, int]:
    """Give the FMU the present values, and rates; the call that did not succeed, or FINE, and its status."""
    given, origins, arrived = numbers(m.given), integers(m.origins), table(m.arrived)
    factors, offsets = numbers(m.factors), numbers(m.offsets)
    n = arrived.shape[1]
    for j in range(turn.first_given, turn.first_given + turn.given_count):
        row = origins[j] // n
        value = arrived[row, origins[j] % n] if row < arrived.shape[0] else 0.0
        given[j] = factors[j] * value + offsets[j]
    return give(turn)


@compiled
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


@compiled
def _read(turn: Any, m: Any) -> tuple[int, int]:
    """Store the FMU's outputs and rates in the exchange; NOT_FINITE if one is not."""
    call, status = take(turn)
    if call != FINE:
        return call, status
    taken, places, arrived = numbers(m.taken), integers(m.places), table(m.arrived)
    n = arrived.shape[1]
    finite = True
    for j in range(turn.first_taken, turn.first_taken + turn.taken_count):
        finite &= np.isfinite(taken[j])
        arrived[places[j] // n, places[j] % n] = taken[j]
    return (FINE if finite else NOT_FINITE), status
