"""Sweeps: participants make a step, or none, and their outputs are read.

Sweeps run in every macro step, so each is bound once to the memory that it needs. If all its participants
offer calls to compiled code it is one compiled function (`compiled_sweeps`), otherwise it is Python.
"""

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from .compiled_sweeps import CompiledSweep
from .exchange import Exchange
from .signals import finite, gather, interpolate_part


@dataclass(frozen=True)
class SweepKind:
    """What a sweep does with its participants.

    `steps`: each makes the step under the signals; otherwise no time passes, and each is given the present
    values and rates. `in_turn`: each is read before the next one goes on, and after a step its signals go
    through its new values; otherwise all go on, then all are read.
    """

    steps: bool
    in_turn: bool

    def __call__(self, exchange: Exchange, order: tuple[int, ...]) -> Callable[[float, float], None]:
        """The sweep over these participants, for a time and a step."""
        offered = exchange.offers.calls
        if order and offered.keys() >= set(order):
            calls = [offered[i] for i in order]
            return CompiledSweep(exchange, calls, order, self.steps, self.in_turn)
        return self._bind_in_python(exchange, order)

    def _bind_in_python(self, e: Exchange, order: tuple[int, ...]) -> Callable[[float, float], None]:
        steps, relays, counts, degree = self.steps, self.steps and self.in_turn, e.calls, e.wiring.degree
        history, values, rates, inputs = e.state.history, e.state.values, e.state.rates, e.all_inputs
        signals = e.signals if steps else np.zeros_like(e.signals)
        present, arrived = signals[:2], e.state.arrived[: len(signals)]
        spent, turns = e.effort.stepping, []
        for group in [(i,) for i in order] if self.in_turn else [order]:
            units = [e.participants[i] for i in group]
            moves = [(i, unit.write, unit.advance) for i, unit in zip(group, units, strict=True)]
            own = e.wiring.slices[group[0]] if self.in_turn else slice(0, len(e.wiring.sources))
            reads = [(i, unit.read) for i, unit in zip(group, units, strict=True)]
            turns.append((*e.locate_inputs(group), moves, reads, own.start, own.stop))

        def run(time: float, step: float) -> None:
            for sources, places, moves, reads, first, last in turns:
                if not steps:
                    present[:] = arrived
                gather(signals, sources, places, inputs)
                begin = perf_counter()
                for i, write, advance in moves:
                    write()
                    if steps:
                        advance(time, step)
                        counts[i] += 1
                    spent[i] += (end := perf_counter()) - begin
                    begin = end
                for i, read in reads:
                    read()
                    spent[i] += (end := perf_counter()) - begin
                    begin = end
                fine = (
                    interpolate_part(
                        history.memory,
                        history.count,
                        degree,
                        time + step,
                        values,
                        rates,
                        signals,
                        first,
                        last,
                    )
                    if relays
                    else finite(values, rates, first, last)
                )
                if not fine:
                    e.refuse(slice(first, last))

        return run


JACOBI = SweepKind(steps=True, in_turn=False)
GAUSS_SEIDEL = SweepKind(steps=True, in_turn=True)
PROPAGATE = SweepKind(steps=False, in_turn=True)


def propagate(exchange: Exchange, order: tuple[int, ...], time: float) -> None:
    """Give the present values, and rates, to each participant in turn and read its answer."""
    exchange.sweep(PROPAGATE, order, time, 0.0)
