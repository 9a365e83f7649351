"""Passes: some participants make a step and their outputs are read, all together or one after the other.

They run in every macro step, so each is bound once to all that it needs, and looks at many values in one
call of compiled code rather than in one for each participant.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numba
import numpy as np

from ..participants.fmu import FmuParticipant
from . import compiled_sweeps as fmu_passes
from .signals import finite, gather, gather_flat, interpolate_part, relay

if TYPE_CHECKING:
    from .exchange import Exchange

Pass = Callable[[float, float], None]


def together(exchange: Exchange, order: Sequence[int]) -> Pass:
    """All advance with the signals as they are, then all are read."""
    if fmus := _fmus(exchange, order):
        return fmu_passes.FmuPass(exchange, fmus, order, fmu_passes.together)
    e, calls = exchange, exchange.calls
    signals, values, rates, inputs = e.signals, e.values, e.rates, e.all_inputs
    n = len(e.sources)
    # Where each number of the inputs lies in the signals: participant by participant, row by row.
    places = [np.zeros(0, dtype=np.int64)]
    rows = np.arange(e.degree + 1)[:, None]
    feeding = [np.ravel(n * rows + e.columns[i]) for i in order]
    targets = [np.arange(e.offsets[i], e.offsets[i + 1]) for i in order]
    sources = np.concatenate(places + feeding)
    into = np.concatenate(places + targets)
    moves = [(i, e.participants[i].write, e.participants[i].advance) for i in order]
    reads = [e.participants[i].read for i in order]

    def run(time: float, step: float) -> None:
        gather_flat(signals, sources, into, inputs)
        for i, write, advance in moves:
            write()
            advance(time, step)
            calls[i] += 1
        for read in reads:
            read()
        if not finite(values, rates, 0, n):
            e.refuse(slice(0, n))

    return run


def in_turn(exchange: Exchange, order: Sequence[int]) -> Pass:
    """One after the other, the signals of each interpolating what it arrived at before the next advances."""
    if fmus := _fmus(exchange, order):
        return fmu_passes.FmuPass(exchange, fmus, order, fmu_passes.in_turn)
    e, calls = exchange, exchange.calls
    signals = e.signals
    first = (e.columns[order[0]], e.inputs[order[0]])
    turns = []
    for i, following in zip(order, [*order[1:], order[0]], strict=True):
        unit = e.participants[i]
        turns.append((i, unit.write, unit.advance, unit.read, _arrival(e, i, following)))

    def run(time: float, step: float) -> None:
        end = time + step
        gather(signals, *first)
        for i, write, advance, read, arrived in turns:
            write()
            advance(time, step)
            calls[i] += 1
            read()
            if not arrived(end):
                e.refuse(e.slices[i])

    return run


def settled(exchange: Exchange, order: Sequence[int]) -> Pass:
    """No time passes: one after the other is given the present values, and rates, and its answer is read."""
    if fmus := _fmus(exchange, order):
        return fmu_passes.FmuPass(exchange, fmus, order, fmu_passes.settled)
    e = exchange
    present = np.zeros_like(e.signals)
    arrived = e.arrived[: len(present)]
    turns = [(i, e.columns[i], e.inputs[i], e.participants[i].write) for i in order]

    def run(time: float, step: float) -> None:
        for i, columns, inputs, write in turns:
            present[:2] = arrived
            gather(present, columns, inputs)
            write()
            e.read(i)

    return run


def _arrival(exchange: Exchange, i: int, following: int) -> Callable[[float], bool]:
    """Signals of participant i through its new values, and from them the inputs of the following one."""
    e, h = exchange, exchange.history
    own, degree, signals, values = e.slices[i], e.degree, e.signals, e.values
    columns, inputs = e.columns[following], e.inputs[following]
    first, last = own.start, own.stop
    times, past = h.times, h.values

    def arrived(end: float) -> bool:
        return relay(
            times, past, h.degrees, h.count, degree, end, values, signals, first, last, columns, inputs
        )

    def arrived_with_rates(end: float) -> bool:
        fine: bool = interpolate_part(
            times, past, h.rates, h.rated, h.degrees, h.smooth, h.end_smooth, h.count, degree, end, values,
            e.rates, signals, first, last,
        )  # fmt: skip
        gather(signals, columns, inputs)
        return fine

    return arrived_with_rates if degree == 3 else arrived


def _fmus(exchange: Exchange, order: Sequence[int]) -> list[FmuParticipant]:
    """The FMUs of a pass; none where compiled code is off, or another kind is among them, one wrapped, or one
    whose calls compiled code cannot make."""
    units = [exchange.participants[i] for i in order]
    fmus = [unit for unit in units if isinstance(unit, FmuParticipant) and unit.compilable]
    return fmus if len(fmus) == len(units) and not numba.config.DISABLE_JIT else []
