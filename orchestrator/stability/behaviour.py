"""How a method behaves about a point against the macro step, and where its stability ends."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from models.quantities import Vector
from models.system import Port

from ..errors import NonConvergenceError
from ..masters import Master
from .operator import Bench, MacroStep, contraction, macro_step, runs_away, spectral_radius
from .points import Point

# Growth per macro step, beyond the system's own, that rounding alone may show: a double eigenvalue one (a
# free flywheel's angle and speed) splits by the root of 1e-16, and scaling adds a factor.
ROUNDING = 1e-6
# A system that grows by itself may be coupled into growing so much faster, which is an error and no more.
FASTER = 1.1
# Steps are compared at powers of this; between two of them the limit is bisected so often.
RATIO, BISECTIONS = math.sqrt(2.0), 7
# Beyond this growth per step there is nothing to be seen in a picture.
SEEN = 30.0
# A limit is looked for down to the scenario's step over this.
SHORTEST = 4096.0


@dataclass(frozen=True)
class At:
    """A method about a point at one macro step.

    `radius` is the spectral radius of the macro step over the system's own growth, stable up to 1;
    `contraction` that of a plain iteration's sweep (implicit masters only). NaN: it does not converge.
    """

    step: float
    radius: float
    contraction: float

    @property
    def stable(self) -> bool:
        return self.radius <= 1.0 + ROUNDING


class Behaviour:
    """A master on the linear participants about a point."""

    def __init__(self, point: Point, master: Master, watched: Mapping[str, Sequence[str]]) -> None:
        self.point, self.master = point, master
        self.bench = Bench(point.system, point.linears, master.degree, watched)
        self._known: dict[float, MacroStep | None] = {}

    @property
    def sources(self) -> list[Port]:
        return self.bench.exchange.sources

    def operator(self, step: float) -> MacroStep | None:
        """The macro step; None where the master's iteration does not converge."""
        if step not in self._known:
            try:
                self._known[step] = macro_step(self.bench, self.master, step)
            except NonConvergenceError:
                self._known[step] = None
        return self._known[step]

    def at(self, step: float) -> At:
        operator = self.operator(step)
        shrink = contraction(self.bench, step) if self.master.implicit else math.nan
        if operator is None:
            return At(step, math.nan, shrink)
        radius = spectral_radius(operator.matrix) * math.exp(-min(FASTER * self.point.growth * step, 700.0))
        return At(step, radius, shrink)

    def effort(self, step: float, amounts: Vector) -> float:
        """Steps of participants in one macro step in which the true solution misses by `amounts`."""
        e = self.bench.exchange
        before = sum(e.calls)
        self.bench.follow(amounts, step)
        self.bench.put(np.zeros(self.bench.size), step)
        try:
            self.master.step(e, 0.0, step)
        except NonConvergenceError:
            return math.inf
        return float(sum(e.calls) - before)

    def culprit(self, step: float) -> Port | None:
        """What runs away at a step that is too long."""
        operator = self.operator(step)
        return None if operator is None else runs_away(operator, self.sources)


def largest_stable(
    at: Callable[[float], At], first: float, longest: float, seen: list[At], ratio: float = RATIO
) -> float:
    """The step up to which all are stable, looked for from `first` on; infinite if `longest` is stable.

    `seen` takes what was found at powers of `ratio`, ascending. Zero if no step is stable.
    """
    step = first
    seen.append(at(step))
    while not seen[0].stable:
        if step <= first / SHORTEST:
            return 0.0
        step /= 4.0
        seen.insert(0, at(step))
    good = bad = 0.0
    for found in seen:
        if not found.stable:
            bad = found.step
            break
        good = found.step
    step = seen[-1].step
    while step * ratio <= longest and not seen[-1].radius > SEEN:
        step *= ratio
        seen.append(at(step))
        if not bad:
            good, bad = (step, 0.0) if seen[-1].stable else (good, step)
    return bisected(at, good, bad) if bad else math.inf


def bisected(at: Callable[[float], At], good: float, bad: float) -> float:
    """The end of stability between a stable and an unstable step."""
    for _ in range(BISECTIONS):
        middle = math.sqrt(good * bad)
        good, bad = (middle, bad) if at(middle).stable else (good, middle)
    return good


def hardest(
    points: Iterable[Point],
    master: Master,
    first: float,
    longest: float,
    watched: Mapping[str, Sequence[str]],
) -> tuple[Point, float]:
    """Of the points the one at which `master` has its smallest limit, and that limit."""
    worst: Point | None = None
    limit = math.inf
    for point in points:
        behaviour = Behaviour(point, master, watched)
        if worst is None or not behaviour.at(min(limit, longest)).stable:
            found = largest_stable(behaviour.at, first, longest, [])
            if worst is None or found < limit:
                worst, limit = point, found
    assert worst is not None
    return worst, limit
