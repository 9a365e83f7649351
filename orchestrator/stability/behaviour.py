"""How a method behaves about a point against the macro step, and where its stability ends."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from models.core.quantities import Vector
from models.core.system import Port, System

from ..errors import NonConvergenceError
from ..masters import Master
from .converged import Converged
from .linear_participants import Bench
from .operator import MacroStep, macro_step
from .points import Point
from .spectra import runs_away, spectral_radius

# Growth per macro step, beyond the system's own, that rounding alone may show: a double eigenvalue one (a
# free flywheel's angle and speed) splits by the root of 1e-16, and scaling adds a factor.
ROUNDING = 1e-6
# A system that grows by itself may be coupled into growing so much faster, which is an error and no more.
FASTER = 1.1
# Spacing of the scan for the first unstable step: as a share of the step, and in radians of the fastest
# participant's own oscillation. An island of instability that is narrower can be missed.
SPACING = 0.03
# Participants' oscillations that have decayed by exp(-this) within a step play no part in the spacing.
DECAYED = 5.0
# Bisections of the first interval in which stability ends; ratio of the steps sampled beyond it.
BISECTIONS, RATIO = 6, math.sqrt(2.0)
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
        self._last: tuple[float, MacroStep | None, float] | None = None

    @property
    def sources(self) -> list[Port]:
        """The exchanged values."""
        return self._benches.of(self.point, self.master, 1).exchange.sources

    @property
    def nominal(self) -> Vector:
        """Their nominal sizes."""
        return self._benches.of(self.point, self.master, 1).nominal

    @property
    def degrees(self) -> Vector:
        """Those of the signals through them: no higher than participants follow."""
        return self._benches.of(self.point, self.master, 1).degrees

    def operator(self, step: float) -> MacroStep | None:
        """The macro step; None where the master's iteration does not converge."""
        return self._evaluate(step)[0]

    def _evaluate(self, step: float) -> tuple[MacroStep | None, float]:
        """The macro step, and how a plain iteration contracts in it (see `At`)."""
        if self._last is None or self._last[0] != step:
            self._last = (step, *self._linearised_step(step))
        return self._last[1:]

    def _linearised_step(self, step: float) -> tuple[MacroStep | None, float]:
        bench, stepping, contraction = self._benches.of(self.point, self.master), self.master, math.nan
        if self.master.implicit:
            stepping = Converged(self.master, bench, step)
            radii = [spectral_radius(matrix) for matrix in stepping.sweeps.values()]
            contraction = max(radii, default=0.0)
            if not self._converges(step):
                return None, contraction
        try:
            return macro_step(bench, stepping, step), contraction
        except np.linalg.LinAlgError:
            return None, contraction

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
        operator, contraction = self._evaluate(step)
        if operator is None:
            return At(step, math.nan, contraction)
        radius = spectral_radius(operator.matrix) * math.exp(-min(FASTER * self.point.growth * step, 700.0))
        return At(step, radius, contraction)

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


def largest_stable(behaviour: Behaviour, first: float, longest: float, seen: list[At]) -> float:
    """The step at which stability first ends; infinite if all scanned steps up to `longest` are stable.

    Steps are scanned upwards from `first`, or from a stable step below it, with `SPACING`: stability can end
    and return within a few per cent. Zero if no step is stable. `seen` takes what was found, ascending.
    """
    seen.append(behaviour.at(first))
    while not seen[0].stable:
        if seen[0].step <= first / SHORTEST:
            return 0.0
        seen.insert(0, behaviour.at(seen[0].step / 4.0))
    del seen[1:]
    while seen[-1].stable:
        good = seen[-1].step
        if good >= longest:
            return math.inf
        seen.append(behaviour.at(min(good + _spacing(behaviour.point, good), longest)))
    limit = _bisect(behaviour, good, seen[-1].step)
    while seen[-1].step * RATIO <= longest and not seen[-1].radius > SEEN:
        seen.append(behaviour.at(seen[-1].step * RATIO))
    return limit


def _spacing(point: Point, step: float) -> float:
    return SPACING * min(step, 1.0 / max(point.fastest(DECAYED / step), 1e-300))


def _bisect(behaviour: Behaviour, good: float, bad: float) -> float:
    """The end of stability between a stable and an unstable step."""
    for _ in range(BISECTIONS):
        middle = math.sqrt(good * bad)
        good, bad = (middle, bad) if behaviour.at(middle).stable else (good, middle)
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
            found = largest_stable(behaviour, first, longest, [])
            if worst is None or found < limit:
                worst, limit = point, found
    assert worst is not None
    return worst, limit
