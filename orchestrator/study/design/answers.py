"""How the contacts of a train answer to unknowns of its design, at a speed."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.core.quantities import Vector
from models.monolithic.cycle import Cycle


class Column(NamedTuple):
    """An output over the event's angles: its least and largest value around each of them, and the row of the
    cycle where the least one stands."""

    low: Vector
    high: Vector
    row: Vector


class Answer(NamedTuple):
    """Outputs of a cycle at a speed (rad/s), by name, and their derivatives by all unknowns (rows, n)."""

    speed: float
    columns: Mapping[str, Column]
    gradients: Mapping[str, Vector]
    cycle: Cycle

    def worsen(self, there: "Answer", step: Vector) -> "Answer":
        """Lower and higher by what the columns `there`, a step (n,) away, are beyond the foreseen."""
        columns = {}
        for name, one in self.columns.items():
            change = self.gradients[name] @ step
            low = one.low + np.minimum(0.0, there.columns[name].low - one.low - change)
            high = one.high + np.maximum(0.0, there.columns[name].high - one.high - change)
            columns[name] = one._replace(low=low, high=high)
        return self._replace(columns=columns)


def find_dips(film: Vector) -> NDArray[np.bool_]:
    """Where it is thinner than on both sides; nan is none."""
    beside = np.pad(np.nan_to_num(film, nan=math.inf), 1, constant_values=math.inf)
    return np.asarray(film <= np.minimum(beside[:-2], beside[2:]))


def follow_reversal(film: Vector, entraining: Vector, reach: int) -> Vector:
    """By what the film over a cycle's rows changes with the entraining velocity, within `reach` rows of a
    reversal; 0 elsewhere. Less that times the change of the velocity, the film's derivative is that of a dip
    that moves with its reversal: one at a fixed instant would take its slope for a change of its depth."""
    by_row = np.gradient(entraining)
    near = np.abs(entraining) < reach * np.abs(by_row)
    return np.where(near, np.gradient(film) / np.where(near, by_row, 1.0), 0.0)


def differ_by_speed(low: Answer, high: Answer, column: str) -> Vector:
    """Derivative of a column at the higher speed by its logarithm, as of a + b speed^2."""
    share = 2.0 * high.speed**2 / (high.speed**2 - low.speed**2)
    return np.asarray(share * (high.columns[column].low - low.columns[column].low))


def go_on(lower: Mapping[float, Answer], high: Answer, speed: float) -> Answer:
    """Columns at a higher speed (rad/s), as a + b speed^2 from the lowest; without that as they are."""
    low = lower[min(lower)] if lower else high
    if not low.speed < high.speed < speed:
        return high._replace(speed=speed)
    share = (speed**2 - high.speed**2) / (high.speed**2 - low.speed**2)
    columns = {
        name: one._replace(
            low=one.low + share * (one.low - low.columns[name].low),
            high=one.high + share * (one.high - low.columns[name].high),
        )
        for name, one in high.columns.items()
    }
    gradients = {
        name: high.gradients[name] + share * (high.gradients[name] - low.gradients[name])
        for name in high.gradients
    }
    return high._replace(speed=speed, columns=columns, gradients=gradients)
