"""Sequential linear programming: the largest value of an objective within limits.

Each step solves the linear programme of the linearised problem within a box, and is taken where objective and
violations together became better, with a box that grows or shrinks (Fletcher and Sainz de la Maza 1989). A
limit along an angle is hundreds of rows, almost linear in the coefficients of a lift: the programme finds the
active ones itself, and its multipliers are those of the limits.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from models.core.quantities import Vector

# Of the objective, in its own scale, for a violation of a limit by all of its scale.
PENALTY = 100.0
# The step's box, in scales of the unknowns, at first and at the end.
FIRST, LAST = 0.1, 1e-5
MOST_STEPS = 60
# Of the values of a linear limit.
SMALLEST = 1e-12
# Rows of a linear programme at first, and what breaks one of the others.
TIGHTEST, BROKEN = 200, 1e-9
# A violation below this is none.
FULFILLED = 1e-6


Bow = Callable[[Vector], tuple[float, Vector]]


class Rows(NamedTuple):
    """A limit at many places: `excess` <= 0 where it holds, over the limit's scale, and its derivatives by
    the unknowns; `by_limit` is the derivative of the excess by the limit's own size, as a share. A `rare`
    limit is looked at only where an optimum without it breaks it."""

    name: str
    excess: Vector
    gradient: Vector
    by_limit: Vector
    rare: bool = False

    @property
    def violation(self) -> float:
        return float(max(0.0, self.excess.max(initial=0.0)))


class Line(NamedTuple):
    """A linear function of the unknowns: `value` at `place`, with its gradient. As a limit it is at most
    (side 1) or at least (-1) its size; the cam angle (rad) is where it stands, and `scale` the least one of
    its excess. A `bow` gives what the function is beyond its tangent at `place`, and the derivatives of that.
    """

    name: str
    value: float
    gradient: Vector
    place: Vector
    size: float = 0.0
    side: float = 1.0
    angle: float = math.nan
    scale: float = SMALLEST
    bow: Bow = lambda unknowns: (0.0, np.zeros(unknowns.size))

    def at(self, unknowns: Vector) -> float:
        return self.value + float(self.gradient @ (unknowns - self.place)) + self.bow(unknowns)[0]

    def bend(self, unknowns: Vector, value: float, scale: Vector) -> "Line":
        """Where a limit fell short of the foreseen at unknowns: as steep on the way there as it was."""
        way = (unknowns - self.place) / scale
        missed = self.side * max(0.0, self.side * (value - self.at(unknowns)))
        long = float(way @ way) or 1.0
        return self._replace(gradient=self.gradient + missed / long * way / scale)

    def rows(self, unknowns: Vector) -> Rows:
        scale = max(abs(self.size), abs(self.value), self.scale) * self.side
        excess = (self.at(unknowns) - self.size) / scale
        gradient = self.gradient + self.bow(unknowns)[1]
        return Rows(self.name, np.array([excess]), gradient[None] / scale, np.array([-self.size / scale]))


class Local(NamedTuple):
    """A problem at a place: the objective, larger is better, its gradient, and the limits."""

    objective: float
    gradient: Vector
    limits: Sequence[Rows]

    @property
    def merit(self) -> float:
        return self.objective - PENALTY * sum(rows.violation for rows in self.limits)


@dataclass(frozen=True)
class Problem:
    """`evaluate` at unknowns between `low` and `high`; `scale` are their sizes."""

    evaluate: Callable[[Vector], Local]
    low: Vector
    high: Vector
    scale: Vector


class Active(NamedTuple):
    """A limit that holds the objective: the row where it does most, what 1 % more of it would give, and the
    share of it that is left to spare."""

    name: str
    row: int
    gain: float
    spare: float = 0.0


class Optimum(NamedTuple):
    """The unknowns, the problem there, and the limits that hold it, the strongest first."""

    unknowns: Vector
    local: Local
    active: Sequence[Active]

    @property
    def feasible(self) -> bool:
        return all(rows.violation <= FULFILLED for rows in self.local.limits)


def maximise(problem: Problem, start: Vector, box: float = FIRST) -> Optimum:
    """The optimum that steps from `start` lead to; where limits contradict, the least sum of violations."""
    x = np.clip(start, problem.low, problem.high)
    here, largest = problem.evaluate(x), box
    multipliers = [np.zeros(rows.excess.size) for rows in here.limits]
    for _ in range(MOST_STEPS):
        step, predicted, multipliers = _solve(problem, x, here, box)
        gain = predicted - here.merit
        if gain <= 1e-9 * max(1.0, abs(here.objective)):
            break
        there = problem.evaluate(x + step)
        share = (there.merit - here.merit) / gain
        if share > 0.05:
            x, here = x + step, there
            box = min(largest, 2.0 * box) if share > 0.75 else box
        else:
            box *= 0.25
        if share < 0.25:
            box *= 0.5
        if box < LAST:
            break
    return Optimum(x, here, _find_active(here.limits, multipliers))


def _solve(problem: Problem, x: Vector, here: Local, box: float) -> tuple[Vector, float, list[Vector]]:
    """The best step within the box, the merit that it promises, and the multipliers of all rows."""
    n, m = x.size, len(here.limits)
    reach = box * problem.scale
    low, high = np.maximum(problem.low - x, -reach), np.minimum(problem.high - x, reach)
    kept, matrices, bounds = [], [], []
    for i, rows in enumerate(here.limits):
        most = np.abs(rows.gradient) @ np.maximum(-low, high)
        near = rows.excess + most > 0.0
        kept.append(near)
        violated = np.zeros((int(near.sum()), m))
        violated[:, i] = -1.0
        matrices.append(np.hstack([rows.gradient[near], violated]))
        bounds.append(-rows.excess[near])
    cost = np.append(-here.gradient, np.full(m, PENALTY))
    # The programme's own scales are 1: steps in boxes, rows in their largest entry.
    scale = np.append(reach, np.ones(m))
    matrix, bound = np.vstack(matrices) * scale, np.concatenate(bounds)
    size = np.maximum(np.abs(matrix[:, :n]).max(axis=1, initial=0.0), 1e-12)
    limits = [*zip(low / reach, high / reach, strict=True), *[(0.0, None)] * m]
    matrix, bound = matrix / size[:, None], bound / size
    # Few rows hold: the tightest are taken at first, then those that the optimum breaks.
    taken = np.zeros(bound.size, dtype=np.bool_)
    rare = np.repeat([rows.rare for rows in here.limits], [int(near.sum()) for near in kept])
    taken[np.argsort(np.where(rare, np.inf, bound))[:TIGHTEST]] = True
    taken &= ~rare
    while True:
        found = linprog(cost * scale, matrix[taken], bound[taken], bounds=limits, method="highs")
        if found.x is None:
            return np.zeros(n), here.merit, [np.zeros(rows.excess.size) for rows in here.limits]
        broken = (matrix @ found.x - bound > BROKEN) & ~taken
        if not broken.any():
            break
        taken |= broken
    forces = np.zeros(bound.size)
    forces[taken] = -found.ineqlin.marginals / size[taken]
    multipliers = []
    for rows, near in zip(here.limits, kept, strict=True):
        spread = np.zeros(rows.excess.size)
        spread[near], forces = forces[: int(near.sum())], forces[int(near.sum()) :]
        multipliers.append(spread)
    return found.x[:n] * reach, here.objective - float(found.fun), multipliers


def _find_active(limits: Sequence[Rows], multipliers: Sequence[Vector]) -> list[Active]:
    found = [
        Active(rows.name, int(np.argmax(force)), float(-0.01 * force @ rows.by_limit))
        for rows, force in zip(limits, multipliers, strict=True)
        if force.max(initial=0.0) > 1e-9
    ]
    return sorted(found, key=lambda one: -abs(one.gain))
