"""Sweeps: participants make a step and their outputs are read, all at once or one after the other.

Sweeps run in every macro step, so each is bound once to the memory that it needs. Where all participants of a
sweep offer calls to compiled code, the sweep is one compiled function (`compiled_sweeps`); else it is Python.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..participants.compiled import CompiledCalls
from . import compiled_sweeps
from .compiled_sweeps import CompiledSweep
from .signals import finite, gather, gather_flat, interpolate_part, relay

if TYPE_CHECKING:
    from .coupling import Coupling

Sweep = Callable[[float, float], None]
# Binds a sweep over participants, by their numbers.
SweepKind = Callable[["Coupling", tuple[int, ...]], Sweep]


def jacobi_sweep(coupling: Coupling, order: tuple[int, ...]) -> Sweep:
    """All advance with the signals as they are, then all are read."""
    if offered := _offered_calls(coupling, order):
        return CompiledSweep(coupling, offered, order, compiled_sweeps.jacobi_sweep)
    e, calls = coupling, coupling.calls
    signals, values, rates, inputs = e.signals, e.state.values, e.state.rates, e.all_inputs
    n = len(e.wiring.sources)
    # Where each number of the inputs lies in the signals: participant by participant, row by row.
    places = [np.zeros(0, dtype=np.int64)]
    rows = np.arange(e.wiring.degree + 1)[:, None]
    feeding = [np.ravel(n * rows + e.wiring.columns[i]) for i in order]
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


def gauss_seidel_sweep(coupling: Coupling, order: tuple[int, ...]) -> Sweep:
    """One after the other, the signals of each interpolating what it arrived at before the next advances."""
    if offered := _offered_calls(coupling, order):
        return CompiledSweep(coupling, offered, order, compiled_sweeps.gauss_seidel_sweep)
    e, calls = coupling, coupling.calls
    signals = e.signals
    first = (e.wiring.columns[order[0]], e.inputs[order[0]])
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
                e.refuse(e.wiring.slices[i])

    return run


def propagate(coupling: Coupling, order: tuple[int, ...]) -> Sweep:
    """No time passes: one after the other is given the present values, and rates, and its answer is read."""
    if calls := _offered_calls(coupling, order):
        return CompiledSweep(coupling, calls, order, compiled_sweeps.propagate)
    e = coupling
    present = np.zeros_like(e.signals)
    arrived = e.state.arrived[: len(present)]
    turns = [(i, e.wiring.columns[i], e.inputs[i], e.participants[i].write) for i in order]

    def run(time: float, step: float) -> None:
        for i, columns, inputs, write in turns:
            present[:2] = arrived
            gather(present, columns, inputs)
            write()
            e.read(i)

    return run


def _arrival(coupling: Coupling, i: int, following: int) -> Callable[[float], bool]:
    """Signals of participant i through its new values, and from them the inputs of the following one."""
    e, h = coupling, coupling.state.history
    own, degree, signals, values = e.wiring.slices[i], e.wiring.degree, e.signals, e.state.values
    columns, inputs = e.wiring.columns[following], e.inputs[following]
    first, last = own.start, own.stop
    times, past = h.times, h.values

    def arrived(end: float) -> bool:
        return relay(
            times, past, h.degrees, h.count, degree, end, values, signals, first, last, columns, inputs
        )

    def arrived_with_rates(end: float) -> bool:
        fine: bool = interpolate_part(
            times, past, h.rates, h.rated, h.degrees, h.smooth, h.end_smooth, h.count, degree, end, values,
            e.state.rates, signals, first, last,
        )  # fmt: skip
        gather(signals, columns, inputs)
        return fine

    return arrived_with_rates if degree == 3 else arrived


def _offered_calls(coupling: Coupling, order: Sequence[int]) -> list[CompiledCalls]:
    """The calls that compiled code can make; none if a participant of the sweep offers none."""
    offers = [coupling.offers[i] for i in order]
    calls = [offer for offer in offers if isinstance(offer, CompiledCalls)]
    return calls if len(calls) == len(offers) else []
