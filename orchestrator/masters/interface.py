"""The interface of a part of the participants: what an iteration makes agree, as one vector."""

from __future__ import annotations

from typing import Any

import numpy as np

from models.compile.array_pointers import ArrayPointers, integer_table, integers, numbers, table
from models.compile.compiled import compiled
from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.signals import STEPWISE, evaluate, interpolate_part

# A wrong end rate bends a cubic signal by 4/27 of it times the step at most.
BEND = 4.0 / 27.0


class Interface:
    """The end values, and for Hermite signals the end rates, of a part's sources as one vector.

    In nominal units; a rate counts as what it bends its signal by. Bound to the exchange's memory, on which
    compiled code does what happens in every sweep.
    """

    def __init__(self, coupling: Coupling, part: tuple[int, ...]) -> None:
        self._coupling = coupling
        self.slices = [coupling.wiring.slices[i] for i in part]
        own = np.concatenate([np.arange(s.start, s.stop) for s in self.slices])
        # What is held over the step needs no agreement.
        held = (coupling.wiring.degrees == STEPWISE) & (coupling.wiring.degree > 0)
        self.sources = own[np.isin(own, coupling.wiring.connected) & ~held[own]]
        self.rated = self.sources[coupling.state.history.rated[self.sources]]
        self.size = len(self.sources) + len(self.rated)
        self._nominal = coupling.wiring.nominal[self.rated]
        scale = np.concatenate([coupling.wiring.nominal[self.sources], self._nominal])
        self._rate_scale = scale[len(self.sources) :]
        bounds = np.array([(s.start, s.stop) for s in self.slices], dtype=np.int64)
        self._memory = ArrayPointers(
            sources=self.sources, rate_sources=self.rated, bounds=bounds, scale=scale,
            assumed=coupling.state.arrived.copy(), arrived=coupling.state.arrived, signals=coupling.signals,
        )  # fmt: skip

    def measure(self, step: float) -> None:
        """Count rates as what they bend a signal by over such a step."""
        np.divide(self._nominal, BEND * step, out=self._rate_scale)

    def gather(self) -> Vector:
        """The vector made of what the sources arrived at."""
        found = np.empty(self.size)
        _gather(self._memory.record, found)
        return found

    def predict(self, step: float) -> Vector:
        """The vector at the end of the signals as they are."""
        found = np.empty(self.size)
        _predict(self._memory.record, step, found)
        return found

    def assume(self, vector: Vector, end: float) -> None:
        """Let the part's signals go to the vector's content at the time `end`."""
        history = self._coupling.state.history
        _assume(self._memory.record, history.memory, vector, history.count, end)

    def find_source(self, element: int) -> int:
        """The source that an element of the vector belongs to."""
        n = len(self.sources)
        return int(self.sources[element] if element < n else self.rated[element - n])


def bind_interface(coupling: Coupling, part: tuple[int, ...], step: float) -> Interface:
    """That of a part, made at its first use, in the units of a step."""
    found = coupling.bind(Interface, part)
    found.measure(step)
    return found


@compiled
def _gather(memory: Any, found: Any) -> None:
    m = memory[0]
    _scaled(table(m.arrived), integers(m.sources), integers(m.rate_sources), numbers(m.scale), found)


@compiled
def _predict(memory: Any, step: float, found: Any) -> None:
    m = memory[0]
    assumed = table(m.assumed)
    evaluate(table(m.signals), step, assumed[0], assumed[1])
    _scaled(assumed, integers(m.sources), integers(m.rate_sources), numbers(m.scale), found)


@compiled
def _scaled(ends: Any, sources: Any, rated: Any, scale: Any, found: Any) -> None:
    n = sources.shape[0]
    for j in range(n):
        found[j] = ends[0, sources[j]] / scale[j]
    for j in range(rated.shape[0]):
        found[n + j] = ends[1, rated[j]] / scale[n + j]


@compiled
def _assume(memory: Any, history: Any, vector: Any, known: int, end: float) -> None:
    m = memory[0]
    sources, rates, scale = integers(m.sources), integers(m.rate_sources), numbers(m.scale)
    assumed, signals, bounds = table(m.assumed), table(m.signals), integer_table(m.bounds)
    n = sources.shape[0]
    for j in range(n):
        assumed[0, sources[j]] = vector[j] * scale[j]
    for j in range(rates.shape[0]):
        assumed[1, rates[j]] = vector[n + j] * scale[n + j]
    for k in range(bounds.shape[0]):
        interpolate_part(
            history, known, signals.shape[0] - 1, end, assumed[0], assumed[1], signals, bounds[k, 0],
            bounds[k, 1],
        )  # fmt: skip
