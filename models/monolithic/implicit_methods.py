"""Two methods in fixed steps for `ImplicitProblem`: a one-step and a multistep one.

A mass that rings on a hard film decides how long steps may be: of methods of order 2, steps of 1 us have the
error of 8 us (the one-step method here) or 2 us (the multistep one).
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..core.quantities import Vector
from ..core.system import ModelError
from .implicit import GUESS_POINTS, ImplicitProblem, NotSolvedError

# L-stable, order 4, all stages with the same interval (Hairer and Wanner, Solving ODEs II, table 6.5). The
# last stage is the step's end.
TABLEAU = (
    (1 / 4,),
    (1 / 2, 1 / 4),
    (17 / 50, -1 / 25, 1 / 4),
    (371 / 1360, -137 / 2720, 15 / 544, 1 / 4),
    (25 / 24, -49 / 48, 125 / 16, -85 / 12, 1 / 4),
)
BDF_ORDER = 3
# The first step, as a share of the longest, and the factor by which steps may grow: films that do not fit
# their drive move fast at the start, and BDF3 is stable up to a growth of 1.5.
FIRST_SHARE = 1e-3
GROWTH = 1.3


def extrapolate(points: Sequence[tuple[float, Vector]], t: float) -> Vector:
    """The polynomial through instants and states, at t."""
    result = np.zeros_like(points[0][1])
    for i, (at, x) in enumerate(points):
        weight = 1.0
        for k, (other, _) in enumerate(points):
            if k != i:
                weight *= (t - other) / (at - other)
        result += weight * x
    return result


class ImplicitMethod(Protocol):
    """An integrator of implicit problems."""

    name: str
    t: float
    carried: Vector

    def begin(self, t: float, x: Vector, carried: Vector) -> None: ...

    def step(self, h: float) -> Vector:
        """The state x after a step of length h; NotSolvedError."""


class _Stages:
    """The present point, and stages from guesses."""

    def __init__(self, problem: ImplicitProblem) -> None:
        self.problem = problem

    def begin(self, t: float, x: Vector, carried: Vector) -> None:
        self.t, self.x, self.carried = t, x, carried
        self.past = [(t, x)]  # the latest last

    def solve(self, t: float, base: Vector, interval: float) -> tuple[Vector, Vector]:
        """From the extrapolated guess, or, where that leads astray, the present state."""
        try:
            return self.problem.solve(t, extrapolate(self.past, t), base, interval)
        except NotSolvedError:
            return self.problem.solve(t, self.x, base, interval)

    def accept(self, h: float, x: Vector, carried: Vector) -> Vector:
        self.t, self.x, self.carried = self.t + h, x, carried
        self.past = [*self.past[1 - GUESS_POINTS :], (self.t, x)]
        return x


class Sdirk4(_Stages):
    """Singly diagonally implicit Runge-Kutta method of order 4."""

    name = "SDIRK4"

    def step(self, h: float) -> Vector:
        rates: list[Vector] = []
        for row in TABLEAU:
            base, interval = self.carried.copy(), row[-1] * h
            for weight, rate in zip(row, rates, strict=False):
                base += weight * h * rate
            x, carried = self.solve(self.t + sum(row) * h, base, interval)
            rates.append((carried - base) / interval)
        return self.accept(h, x, carried)


class Bdf3(_Stages):
    """Backward differences of order 3 over steps of any lengths; of lower order for the first two."""

    name = "BDF3"

    def begin(self, t: float, x: Vector, carried: Vector) -> None:
        super().begin(t, x, carried)
        self._behind = [(t, carried)]

    def step(self, h: float) -> Vector:
        t = self.t + h
        weights = slope_weights(t, [at for at, _ in self._behind])
        base = np.zeros_like(self.carried)
        for weight, (_, carried) in zip(weights[1:], self._behind, strict=True):
            base -= weight / weights[0] * carried
        x, carried = self.solve(t, base, 1.0 / weights[0])
        self._behind = [(t, carried), *self._behind[: BDF_ORDER - 1]]
        return self.accept(h, x, carried)


def slope_weights(t: float, others: Sequence[float]) -> list[float]:
    """Of the values at t and the others: for the slope at t of the polynomial through them."""
    weights = [sum(1.0 / (t - other) for other in others)]
    for i, at in enumerate(others):
        weight = 1.0 / (at - t)
        for k, other in enumerate(others):
            if k != i:
                weight *= (t - other) / (at - other)
        weights.append(weight)
    return weights


def step_lengths(start: float, times: Vector, longest: float) -> Iterator[tuple[float, bool]]:
    """Steps from `start` through all `times` (but those at the start), and whether each ends at one.

    None is longer than `longest`; they grow by GROWTH at most from FIRST_SHARE of it.
    """
    h, t = FIRST_SHARE * longest / GROWTH, start
    for target in times:
        while t < target:
            left = target - t
            h = min(GROWTH * h, longest)
            count = math.ceil(left / h * (1.0 - 1e-9))
            # Near the end of an interval its rest is parted evenly.
            h = left / count if count <= 2 or h >= longest * (1.0 - 1e-6) else h
            last = count <= 1
            t = float(target) if last else t + h
            yield h, last


@dataclass(frozen=True)
class Trajectory:
    """A solution at n instants: states, inputs, outputs, stored energies and energies counted."""

    state: Vector
    inputs: Vector
    outputs: Vector
    stored: Vector
    energies: Vector


def march_implicit(
    problem: ImplicitProblem,
    method: ImplicitMethod,
    x0: Vector,
    t0: float,
    times: Vector,
    longest: float,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """The course by one method; ModelError where a step has no solution."""
    e, rows = problem.evaluation, []

    def record(t: float, x: Vector, begun: Vector) -> None:
        e.outputs(t, begun)
        stored = problem.energies.stored(t, begun, e.u)
        outputs = e.outputs(t, x).copy()
        rows.append((x, e.u.copy(), outputs, stored, problem.energy(method.carried).copy()))

    x, carried = problem.start(t0, x0)
    method.begin(t0, x, carried)
    if times[0] == t0:
        # Outputs as masters see them, before the fields have begun; energies after.
        record(t0, x0, x)
    for h, recorded in step_lengths(t0, times, longest):
        t = method.t
        try:
            x = method.step(h)
        except NotSolvedError as error:
            raise ModelError(
                f"{method.name} failed at t = {t:.9g} s in a step of {h:.3g} s: {error}; shorten the "
                f"reference's steps (longest_step = {longest:g} s)"
            ) from None
        if recorded:
            record(method.t, x, x)
            if progress is not None:
                progress(len(rows) / times.size)
    return Trajectory(*(np.array(part) for part in zip(*rows, strict=True)))
