"""How a method behaves about a point against the macro step, and where its stability ends."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from models.quantities import Vector
from models.system import Port, System

from ..errors import NonConvergenceError
from ..masters import Master
from .bench import Bench
from .converged import Converged
from .operator import MacroStep, macro_step
from .points import Point
from .spectra import runs_away, spectral_radius

# Growth per macro step, beyond the system's own, that rounding alone may show: a double eigenvalue one (a
# free flywheel's angle and speed) splits by the root of 1e-16, and scaling adds a factor.
ROUNDING = 1e-6
# A system that grows by itself may be coupled into growing so much faster, which is an error and no more.
FASTER = 1.1
# Steps are compared at powers of this; between two of them the limit is bisected so often.
RATIO, BISECTIONS = math.sqrt(2.0), 7
# Beyond this growth per step there is nothing to be seen in a picture.
SEEN = 30.0
# Columns of a matrix that are read out together.
COPIES = 64
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


class Benches:
    """A system's benches, made when first asked for: with copies for matrices, with one for a step."""

    def __init__(self, system: System, watched: Mapping[str, Sequence[str]] | None = None) -> None:
        self._system, self._watched = system, watched or {}
        self._made: dict[tuple[int, int], Bench] = {}

    def of(self, point: Point, master: Master, count: int = COPIES) -> Bench:
        """The bench with so many copies about the point, for the master."""
        key = (master.degree, count)
        if key not in self._made:
            self._made[key] = Bench(self._system, master.degree, self._watched, count)
        self._made[key].about(point.linears, master)
        return self._made[key]


class Behaviour:
    """A master on the linear participants about a point."""

    def __init__(self, point: Point, master: Master, benches: Benches | None = None) -> None:
        self.point, self.master = point, master
        self._benches = benches or Benches(point.system)
        self._known: dict[float, MacroStep | None] = {}

    @property
    def sources(self) -> list[Port]:
        """The exchanged values."""
        return self._benches.of(self.point, self.master, 1).exchange.sources

    @property
    def nominal(self) -> Vector:
        """Their nominal sizes."""
        return self._benches.of(self.point, self.master, 1).nominal

    def operator(self, step: float) -> MacroStep | None:
        """The macro step; None where the master's iteration does not converge."""
        if step not in self._known:
            self._known[step] = self._operator(step)
        return self._known[step]

    def _operator(self, step: float) -> MacroStep | None:
        if self.master.implicit and not self._converges(step):
            return None
        try:
            return macro_step(self._benches.of(self.point, self.master), self.master, step)
        except np.linalg.LinAlgError:
            return None

    def _converges(self, step: float) -> bool:
        """The master's own iteration does, from data with a share of everything."""
        single = self._benches.of(self.point, self.master, 1)
        single.put(np.random.default_rng(1).standard_normal((single.size, 1)), step)
        try:
            single.after(self.master, step)
        except NonConvergenceError:
            return False
        return True

    def at(self, step: float) -> At:
        operator = self.operator(step)
        shrink = self._contraction(step) if self.master.implicit else math.nan
        if operator is None:
            return At(step, math.nan, shrink)
        radius = spectral_radius(operator.matrix) * math.exp(-min(FASTER * self.point.growth * step, 700.0))
        return At(step, radius, shrink)

    def _contraction(self, step: float) -> float:
        """Spectral radius of what a sweep makes of assumed end values: how a plain iteration contracts.

        Of the parts that the master iterates. Zero without such parts.
        """
        swept = Converged(self.master, self._benches.of(self.point, self.master), step).sweeps
        return max((spectral_radius(matrix) for matrix in swept.values()), default=0.0)

    def effort(self, step: float, amounts: Vector) -> float:
        """Steps of participants in one macro step in which the true solution misses by `amounts`."""
        single = self._benches.of(self.point, self.master, 1)
        before = sum(single.exchange.calls)
        single.put(np.zeros((single.size, 1)), step)
        single.follow(amounts[:, None], step)
        try:
            self.master.step(single.exchange, 0.0, step)
        except NonConvergenceError:
            return math.inf
        return float(sum(single.exchange.calls) - before)

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
    benches: Benches | None = None,
) -> tuple[Point, float]:
    """Of the points the one at which `master` has its smallest limit, and that limit."""
    worst: Point | None = None
    limit = math.inf
    for point in points:
        behaviour = Behaviour(point, master, benches)
        if worst is None or not behaviour.at(min(limit, longest)).stable:
            found = largest_stable(behaviour.at, first, longest, [])
            if worst is None or found < limit:
                worst, limit = point, found
    assert worst is not None
    return worst, limit
