"""The error that a master would make along a course: what signals miss, carried on by the macro step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.monolithic.course import Course
from models.monolithic.difference import difference
from models.quantities import Vector
from models.system import Port, System

from .missed import missed_by
from .operator import MacroStep

# Twelve times the derivatives at the first two of five points.
ENDS = np.array([[-25.0, 48.0, -36.0, 16.0, -3.0], [-3.0, -10.0, 18.0, -6.0, 1.0]])


@dataclass(frozen=True)
class Sampled:
    """Exchanged values and their rates along a course, (instants x sources), `interval` seconds apart."""

    interval: float
    values: Vector
    rates: Vector

    def every(self, count: int) -> tuple[Vector, Vector]:
        """Values and rates at every `count`-th instant."""
        return self.values[::count], self.rates[::count]


def sampled(course: Course, system: System, sources: list[Port]) -> Sampled:
    """The sources along the course; rates by differences of fourth order."""
    values = course.outputs[:, [system.outputs.index(port) for port in sources]]
    interval = float(course.times[1] - course.times[0])
    return Sampled(interval, values, slopes(values) / interval)


def slopes(values: Vector) -> Vector:
    """Derivatives along the rows (at least five), a unit apart: differences of fourth order, to the ends."""
    found = np.empty_like(values)
    found[2:-2] = 8.0 * (values[3:-1] - values[1:-3]) - (values[4:] - values[:-4])
    found[:2] = ENDS @ values[:5]
    found[-2:] = -(ENDS @ values[:-6:-1])[::-1]
    return found / 12.0


def predicted(step: MacroStep, values: Vector, rates: Vector, nominal: Vector) -> Vector:
    """Relative RMS error of each source, as the comparison with the reference states it.

    `values` and `rates` are the true solution's, a macro step apart. The errors obey e(n+1) = matrix e(n) +
    defect missed(n): linear about one point, so an estimate. Infinite where they leave all bounds.
    """
    driven = (missed_by(values, rates, step.step, step.degree) / nominal) @ step.defect.T
    error = np.zeros_like(values)
    data, newest = np.zeros(step.matrix.shape[0]), step.newest
    matrix = np.ascontiguousarray(step.matrix)
    with np.errstate(over="ignore", invalid="ignore"):
        for n in range(1, len(values)):
            data = matrix @ data + driven[n]
            error[n] = data[newest]
        error = np.nan_to_num(error * nominal, nan=np.inf)
        found = [
            difference(error[:, i] + values[:, i], values[:, i], nominal[i]).relative_rms
            if np.all(np.abs(error[:, i]) < 1e150)
            else np.inf
            for i in range(len(nominal))
        ]
    return np.array(found)
