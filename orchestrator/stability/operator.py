"""The macro step of any master as a matrix, read out of the master itself.

The master steps participants that are exactly linear, a copy for every element of the run's evolving data:
the participants' states, and values (with Hermite signals also rates) at the communication points that are
remembered. No master is described a second time here.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from models.core.quantities import Vector

from ..masters import Master
from .extrapolation_error import ends, shapes
from .linear_participants import Bench


@dataclass(frozen=True)
class MacroStep:
    """data(t + H) = matrix data(t) + defect missed, all in nominal units.

    The data are the participants' states, then `rows` rows of exchanged values, newest first, and, with
    rates, as many rows of those times H. `missed` is by how much the exchanged values of the true solution
    miss the signal's own extrapolation over the step, shape after shape (`missed_by`); `degrees` are those of
    the signals.
    """

    step: float
    degrees: Vector
    states: int
    sources: int
    matrix: Vector
    defect: Vector

    @property
    def newest(self) -> slice:
        """The exchanged values in the data."""
        return slice(self.states, self.states + self.sources)


def macro_step(bench: Bench, master: Master, step: float) -> MacroStep:
    """The matrices of a macro step by `master`, an implicit one as `Converged`.

    LinAlgError where the end values that agree are not determined.
    """
    size, sources = bench.size, bench.sources
    kinds = len(shapes(step, bench.degree))
    columns, defect = np.empty((size, size)), np.empty((size, kinds * sources))
    for part, data in _units(size, bench.count):
        bench.put(data, step)
        columns[:, part] = bench.after(master, step)[:, : data.shape[1]]
    for part, missed in _units(kinds * sources, bench.count):
        bench.put(np.zeros((size, missed.shape[1])), step)
        bench.follow(missed, step)
        defect[:, part] = bench.after(master, step)[:, : missed.shape[1]]
    # The true solution has moved by what was missed; the rest is error.
    rates = bench.states + bench.rows * sources
    for source, degree in enumerate(bench.degrees):
        for kind, (value, rate) in enumerate(ends(step, int(degree)).T):
            defect[bench.states + source, kind * sources + source] -= value
            if bench.rated:
                defect[rates + source, kind * sources + source] -= rate * step
    return MacroStep(step, bench.degrees.copy(), bench.states, sources, columns, defect)


def _units(size: int, count: int) -> Iterator[tuple[slice, Vector]]:
    """The columns of a unit matrix, at most `count` at a time."""
    for first in range(0, size, count):
        part = slice(first, min(first + count, size))
        yield part, np.eye(size)[:, part]
