"""The error that a master would make along a course: what signals miss, carried on by the macro step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from scipy.sparse import csr_array

from models.core.quantities import Vector
from models.core.system import Port, System
from models.monolithic.difference import difference
from models.monolithic.trajectory import Course

from .extrapolation_error import missed_by
from .operator import MacroStep
from .slopes import rates_along


@dataclass(frozen=True)
class Sampled:
    """Exchanged values and their rates along a course, (instants x sources), `interval` seconds apart."""

    interval: float
    values: Vector
    rates: Vector

    def missed(self, count: int, degrees: Vector) -> Vector:
        """What steps of `count` instants miss with signals of these degrees, (steps x shapes x sources)."""
        middles = self.values[count // 2 :: count] if count % 2 == 0 else None
        step = count * self.interval
        found = {
            int(degree): missed_by(self.values[::count], self.rates[::count], step, int(degree), middles)
            for degree in np.unique(degrees)
        }
        shape = next(iter(found.values())).shape
        missed = np.zeros((shape[0], max(one.shape[1] for one in found.values()), shape[2]))
        for degree, one in found.items():
            missed[:, : one.shape[1], degrees == degree] = one[:, :, degrees == degree]
        return missed


def sampled(course: Course, system: System, sources: list[Port]) -> Sampled:
    """The sources along the course, with the rates that participants give."""
    columns = [system.outputs.index(port) for port in sources]
    interval = float(course.times[1] - course.times[0])
    return Sampled(interval, course.outputs[:, columns], rates_along(course, system)[:, columns])


def predicted(step: MacroStep, track: Sampled, count: int, nominal: Vector) -> Vector:
    """Relative RMS error of each source, as the comparison with the reference states it.

    A macro step is `count` instants of the track. The errors obey e(n+1) = matrix e(n) + defect missed(n):
    linear about one point, so an estimate. Infinite where they leave all bounds.
    """
    values = track.values[::count]
    missed = (track.missed(count, step.degrees) / nominal).reshape(len(values), -1)
    driven = missed @ step.defect[:, : missed.shape[1]].T
    error = np.zeros_like(values)
    sparse = csr_array(step.matrix)
    with np.errstate(over="ignore", invalid="ignore"):
        carry(sparse.data, sparse.indices, sparse.indptr, driven, step.newest.start, error)
        error = np.nan_to_num(error * nominal, nan=np.inf)
        found = [
            difference(error[:, i] + values[:, i], values[:, i], nominal[i]).relative_rms
            if np.all(np.abs(error[:, i]) < 1e150)
            else np.inf
            for i in range(len(nominal))
        ]
    return np.array(found)


@numba.njit(cache=True)
def carry(data: Any, columns: Any, rows: Any, driven: Any, first: int, found: Any) -> None:
    """e(n) = matrix e(n - 1) + driven(n) from rest; `found` gets the elements from `first` on."""
    size = driven.shape[1]
    e, before = np.zeros(size), np.zeros(size)
    for n in range(1, driven.shape[0]):
        before[:] = e
        for i in range(size):
            total = driven[n, i]
            for k in range(rows[i], rows[i + 1]):
                total += data[k] * before[columns[k]]
            e[i] = total
        for i in range(found.shape[1]):
            found[n, i] = e[first + i]
