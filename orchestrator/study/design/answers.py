"""How the contacts of a train answer to unknowns of its design, at a speed."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from models.core.quantities import Vector
from models.monolithic.cycle import Cycle


class Column(NamedTuple):
    """An output over the event's angles: its least and largest value around each of them."""

    low: Vector
    high: Vector


class Answer(NamedTuple):
    """Outputs of a cycle at a speed (rad/s), by name, and their derivatives by all unknowns (rows, n)."""

    speed: float
    columns: Mapping[str, Column]
    gradients: Mapping[str, Vector]
    cycle: Cycle


def mend(
    answer: Answer, place: Vector, past: Sequence[tuple[Vector, Mapping[str, Column]]], scale: Vector
) -> Answer:
    """The answer at a place with derivatives that give the columns of other unknowns, the last ones exactly
    [Broyden 1965]; where these are nan, as it was. `scale` are sizes of the unknowns."""
    gradients = {name: gradient.copy() for name, gradient in answer.gradients.items()}
    for unknowns, columns in past:
        step = (unknowns - place) / scale
        if not step.any():
            continue
        for name, gradient in gradients.items():
            there, here = columns[name], answer.columns[name]
            change = 0.5 * (there.low + there.high - here.low - here.high)
            error = np.nan_to_num(change - gradient @ (unknowns - place))
            gradient += np.outer(error, step / scale) / (step @ step)
    return answer._replace(gradients=gradients)


def differ_by_speed(low: Answer, high: Answer, column: str) -> Vector:
    """Derivative of a column at the higher speed by its logarithm, as of a + b speed^2."""
    share = 2.0 * high.speed**2 / (high.speed**2 - low.speed**2)
    return np.asarray(share * (high.columns[column].low - low.columns[column].low))


def go_on(low: Answer, high: Answer, speed: float) -> Answer:
    """Columns at a higher speed (rad/s), as a + b speed^2."""
    share = (speed**2 - high.speed**2) / (high.speed**2 - low.speed**2)
    columns = {
        name: Column(
            *(b + share * (b - a) for a, b in zip(low.columns[name], high.columns[name], strict=True))
        )
        for name in high.columns
    }
    gradients = {
        name: high.gradients[name] + share * (high.gradients[name] - low.gradients[name])
        for name in high.gradients
    }
    return high._replace(speed=speed, columns=columns, gradients=gradients)
