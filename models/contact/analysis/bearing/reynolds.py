"""Reynolds' equation of a plain bearing with p >= 0, by finite volumes.

For a journal at eps along x whose film is squeezed with a velocity u (`contact.short_bearing`), with y = z/R
and the film h in units of the clearance c, the pressure in mu R^2/c^3 is that of

    d/dt(h^3 dp/dt) + d/dy(h^3 dp/dy) >= -12 n.u,   p >= 0,   one of both equal at each place,

which is Reynolds' condition at the beginning and the end of the film (Christopherson 1941). Its matrix is
symmetric: the force is the derivative by u of a convex function, and takes power from every motion. Active
sets (Hintermueller, Ito and Kunisch 2003) find the wet part exactly, from any first guess.

Nodes lie about sqrt(1 - eps) as wide at the thin place, and at most twice as wide as even ones elsewhere.
There are nodes along the edges of grooves, and none in them.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve_banded, cholesky_banded

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
AROUND, ACROSS = 240, 16
# Of the width, nodes are sin(EDGE t)/sin(EDGE): nearer at the edge by the cosine.
EDGE = 1.3


@dataclass(frozen=True)
class Grid:
    """Of half of the width; ratio = L/D; without pressure at the angles `grooves` (rad) from the thin place,
    each `opening` wide (rad)."""

    eps: float
    ratio: float
    grooves: tuple[float, ...] = ()
    around: int = AROUND
    across: int = ACROSS
    opening: float = 0.0

    def _count(self, angle: Array) -> Array:
        """How many nodes lie between 0 and an angle, over `around` and times 2 pi."""
        thin = math.sqrt(1.0 - self.eps)
        return 0.5 * (angle + 2.0 * np.arctan2(np.sin(0.5 * angle), thin * np.cos(0.5 * angle)))

    def _place(self, count: Array) -> Array:
        """The inverse, for counts between -pi and 3 pi."""
        turn = np.where(count > math.pi, 2.0 * math.pi, 0.0)
        angle = np.linspace(-math.pi, math.pi, 4001)
        found = np.interp(count - turn, self._count(angle), angle)
        thin = math.sqrt(1.0 - self.eps)
        for _ in range(4):
            slope = 0.5 + 0.5 * thin / (np.sin(0.5 * found) ** 2 + (thin * np.cos(0.5 * found)) ** 2)
            found = found - (self._count(found) - (count - turn)) / slope
        return np.asarray(found + turn)

    @cached_property
    def counts(self) -> tuple[Array, Mask]:
        """Where the nodes are, in the map's own measure, and which of them are open to pressure."""
        turn = 2.0 * math.pi
        if not self.grooves:
            return np.arange(self.around) * turn / self.around, np.ones(self.around, bool)
        middles = np.sort((np.array(self.grooves) + math.pi) % turn - math.pi)
        ends, begins = self._count(middles - 0.5 * self.opening), self._count(middles + 0.5 * self.opening)
        parts = []
        for begin, end in zip(begins, [*ends[1:], ends[0] + turn], strict=True):
            number = max(1, round(self.around * (end - begin) / turn))
            parts.append(np.linspace(begin, end, number + 1)[: number + (self.opening > 0.0)])
        free = [np.arange(part.size) % (part.size - (self.opening > 0.0)) > 0 for part in parts]
        return np.concatenate(parts), np.concatenate(free)

    @cached_property
    def angle(self) -> Array:
        return self._place(self.counts[0])

    @cached_property
    def between(self) -> Array:
        """Half way to the next node, in the map's measure."""
        places = self.counts[0]
        return self._place(0.5 * (places + np.append(places[1:], places[0] + 2.0 * math.pi)))

    @cached_property
    def weights(self) -> Array:
        """Areas around the nodes, of half of the width."""
        return self.widths[0][:, None] * self.heights[0][None, :]

    @cached_property
    def widths(self) -> tuple[Array, Array]:
        """Around: of the volumes, and from node to node."""
        turn = 2.0 * math.pi
        volume = np.diff(self.between, prepend=self.between[-1] - turn)
        volume[0] %= turn
        return volume, np.append(np.diff(self.angle), (self.angle[0] - self.angle[-1]) % turn)

    @cached_property
    def heights(self) -> tuple[Array, Array]:
        """Across: of the volumes, and from node to node or edge."""
        t = np.arange(self.across + 1) / self.across
        node, face = (self.ratio * np.sin(EDGE * at) / math.sin(EDGE) for at in (t, t[1:] - t[1] / 2.0))
        return np.diff(face, prepend=0.0), np.diff(node)

    def film(self, angle: Array) -> Array:
        return 1.0 - self.eps + 2.0 * self.eps * np.sin(0.5 * angle) ** 2

    def links(self, between: Array, at: Array) -> tuple[Array, Array, Array]:
        """The matrix for h^3 between the nodes and at them: diagonal, to the next around and across."""
        around = (between / self.widths[1])[:, None] * self.heights[0][None, :]
        across = (at * self.widths[0])[:, None] / self.heights[1][None, :]
        diagonal = around + np.roll(around, 1, 0) + across
        diagonal[:, 1:] += across[:, :-1]
        return diagonal, around, across

    @cached_property
    def resistance(self) -> tuple[Array, Array, Array]:
        return self.links(self.film(self.between) ** 3, self.film(self.angle) ** 3)

    def squeezed(self, direction: float) -> Array:
        """12 n.u of each volume for a unit velocity in this direction (rad)."""
        return np.asarray(12.0 * np.cos(self.angle - direction)[:, None] * self.weights)

    def force(self, pressure: Array) -> Array:
        """On the film, over mu R L^3/c^3: along x and y."""
        line = (pressure * self.weights).sum(1) / (4.0 * self.ratio**3)
        return np.array([line @ np.cos(self.angle), line @ np.sin(self.angle)])


def apply(links: tuple[Array, Array, Array], pressure: Array) -> Array:
    """The matrix times the pressure."""
    diagonal, around, across = links
    found = diagonal * pressure - around * np.roll(pressure, -1, 0) - np.roll(around * pressure, 1, 0)
    found[:, :-1] -= across[:, :-1] * pressure[:, 1:]
    found[:, 1:] -= across[:, :-1] * pressure[:, :-1]
    return np.asarray(found)


@dataclass(frozen=True)
class Solution:
    """Pressure of a unit squeeze in a direction; the part that is wet; its factor, from node `start` on."""

    grid: Grid
    pressure: Array
    wet: Mask
    factor: Array
    start: int

    def respond(self, source: Array) -> Array:
        """The pressure of another source on the same wet part, as of a small change: p and its slope are zero
        at the free ends, so that their motion is of second order."""
        wet = np.roll(np.where(self.wet, source, 0.0), -self.start, 0)
        found = cho_solve_banded((self.factor, True), wet.ravel()).reshape(source.shape)
        return np.roll(found, self.start, 0)

    @property
    def force(self) -> Array:
        return self.grid.force(self.pressure)

    @property
    def highest(self) -> float:
        """The highest pressure, by a parabola through three nodes."""
        middle = self.pressure[:, 0]
        i = int(np.argmax(middle))
        turn, places = 2.0 * math.pi, self.grid.angle[[i - 1, i, (i + 1) % middle.size]]
        places = (places - places[1] + math.pi) % turn - math.pi
        curve = np.polyfit(places, middle[[i - 1, i, (i + 1) % middle.size]], 2)
        return float(curve[2] - curve[1] ** 2 / (4.0 * curve[0]))


def _factorise(grid: Grid, wet: Mask, start: int) -> Array:
    """Cholesky's of the wet part, with ones for dry nodes."""
    here = np.roll(wet, -start, 0)
    diagonal, around, across = (np.roll(links, -start, 0) for links in grid.resistance)
    band = np.zeros((grid.across + 1, wet.size))
    band[0] = np.where(here, diagonal, 1.0).ravel()
    band[1].reshape(wet.shape)[:, :-1] = np.where(here[:, :-1] & here[:, 1:], -across[:, :-1], 0.0)
    band[-1].reshape(wet.shape)[:-1] = np.where(here[:-1] & here[1:], -around[:-1], 0.0)
    return np.asarray(cholesky_banded(band, lower=True))


def solve(grid: Grid, direction: float, guess: Mask | None = None) -> Solution:
    """The field for a unit squeeze in this direction (rad). `guess` is the wet part of one nearby.

    Without grooves, the film is dry where it is most opened; ArithmeticError where it would not be.
    """
    source = grid.squeezed(direction)
    start = int(np.argmin(source[:, 0] / grid.weights[:, 0] + 99.0 * grid.counts[1] * bool(grid.grooves)))
    allowed = np.repeat(grid.counts[1][:, None], grid.across, 1)
    allowed[start] = False
    wet = allowed & (source > 0.0 if guess is None else guess)
    for _ in range(2 * grid.around):
        factor = _factorise(grid, wet, start)
        found = Solution(grid, np.zeros(0), wet, factor, start).respond(source)
        lacking = source - apply(grid.resistance, found)
        fuller = allowed & np.where(wet, found > 0.0, lacking > 0.0)
        if np.array_equal(fuller, wet):
            if not grid.grooves and lacking[start].max() > 0.0:
                raise ArithmeticError("a film without a dry place")
            return Solution(grid, found, wet, factor, start)
        wet = fuller
    raise ArithmeticError("the wet part of the film was not found")
