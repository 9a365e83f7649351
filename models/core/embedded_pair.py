"""Few evaluations of an expensive rate: an embedded pair of Runge-Kutta methods for y' = f(y).

Bogacki and Shampine, A 3(2) pair of Runge-Kutta formulas, Appl. Math. Lett. 2 (1989) 321-325: the solution
has order 3, the estimate is its difference from one of order 2. The last evaluation of a step is the first of
the next one, so that a step takes three.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from .errors import ModelError
from .quantities import Vector

Rate = Callable[[Vector], Vector]

# A step grows or shrinks by no more than this, and aims at this share of the error allowed.
LARGEST, SMALLEST, SAFETY = 5.0, 0.25, 0.8
# A step that shrinks below this share of the first one makes no progress.
HOPELESS = 1e-4


@dataclass(frozen=True)
class Step:
    """From `begin` over `length`: states and rates at both ends, and the largest error estimated in a state.

    States are arrays of any shape.
    """

    begin: float
    length: float
    states: tuple[Vector, Vector]
    rates: tuple[Vector, Vector]
    error: float

    def at(self, share: float) -> Vector:
        """The state at a share of the step: the cubic polynomial through states and rates, of order 3."""
        (y0, y1), (f0, f1), x, h = self.states, self.rates, share, self.length
        rise = y1 - y0
        inner = (1.0 - 2.0 * x) * rise + h * ((x - 1.0) * f0 + x * f1)
        return np.asarray((1.0 - x) * y0 + x * y1 + x * (x - 1.0) * inner)


def try_step(rate: Rate, begin: float, length: float, state: Vector, first: Vector) -> Step:
    """One step; `first` is the rate at its begin."""
    second = rate(state + 0.5 * length * first)
    third = rate(state + 0.75 * length * second)
    end = state + length * (2.0 * first + 3.0 * second + 4.0 * third) / 9.0
    last = rate(end)
    error = length * (-5.0 / 72.0 * first + second / 12.0 + third / 9.0 - 0.125 * last)
    return Step(begin, length, (state, end), (first, last), float(np.abs(error).max()))


def march(
    rate: Rate,
    state: Vector,
    now: Vector,
    first: float,
    tolerance: float,
    bounds: Callable[[Vector, Vector], tuple[float, float]],
) -> Iterator[Step]:
    """Steps from `state`, where the rate is `now`, without end; the first one has the length `first`.

    The error of a step is at most `tolerance` times the largest change of a state in it, so that errors add
    up to no more than this share of all changes, but for shortest steps: `bounds(state, rate)` are the
    shortest and the longest step, and the shortest is taken whatever its error. A step that the rate refuses
    by ModelError is made shorter than that; the error is raised where it does not help.
    """
    begin, length, refused = 0.0, first, False
    while True:
        shortest, longest = bounds(state, now)
        length = min(max(length, shortest) if not refused else length, longest)
        try:
            step = try_step(rate, begin, length, state, now)
        except ModelError:
            refused, length = True, SMALLEST * length
            if length < HOPELESS * first:
                raise
            continue
        allowed = tolerance * float(np.abs(step.states[1] - state).max())
        # Of an error per change, of order 2.
        factor = SAFETY * (allowed / step.error) ** 0.5 if step.error > 0.0 else LARGEST
        length *= min(LARGEST, max(SMALLEST, factor))
        if step.error > allowed and step.length > shortest:
            continue
        yield step
        refused = False
        begin, state, now = begin + step.length, step.states[1], step.rates[1]
