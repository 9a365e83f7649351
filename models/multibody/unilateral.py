"""Bodies between walls: free flights that the joints constrain, and impacts with restitution.

A flight is solved as by `solve_projected`; its end, where a gap closes, is found on the dense output. The
impact is that of Newton's law with the joints' impulses, at once for all bodies and for all walls whose gaps
close at that instant:

    M (v+ - v-) = G^T P - J^T Lambda,    J v+ + C_t = 0,    0 <= P, G v+ >= -e G v-, P (G v+ + e G v-) = 0

with the gradients G of the gaps (Moreau 1988). It never adds kinetic energy. Walls are smooth, and sliding on
them is not followed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

from ..core.errors import ModelError
from ..core.quantities import Vector
from .bodies import GROUND, ORIGIN, Point, check_vector
from .forces import LubricatedCam
from .ida import COORDINATE, VELOCITY
from .mechanism import Mechanism, Start
from .motion import Motion, check_request, complete, explain_failure
from .projected import make_flow
from .saddle import solve_saddle
from .tables import Evaluation

# Instants of a step at which gaps are looked at, and the least gap between two of them: two impacts on a wall
# between two instants are missed.
LOOKS = 20
# A bounce that is over after this share of a step is no flight any more.
SHORTEST_BOUNCE = 1e-9
# A body this near to a wall (m) touches it: it strikes all such walls at once, and has to bounce higher.
TOUCHING = 1e-10
# Impacts at one instant, each of which drives the body against another wall.
IMPACTS_AT_ONCE = 100


@dataclass(frozen=True)
class Wall:
    """A plane that the point `at` of a body (in its axes) does not pass: gap n P + clearance >= 0.

    `normal` n is a unit vector of the ground that points away from the wall, `restitution` Newton's e.
    """

    name: str
    body: str
    normal: Point
    clearance: float
    restitution: float
    at: Point = ORIGIN

    def __post_init__(self) -> None:
        """ModelError for values out of range, a normal that is no unit vector, a wall for the ground."""
        check_vector(f"wall {self.name}: normal", self.normal)
        check_vector(f"wall {self.name}: at", self.at)
        if self.body == GROUND or not np.isfinite(self.clearance):
            raise ModelError(
                f"wall {self.name}: body = {self.body}, clearance = {self.clearance:g} m: must be a body "
                "that moves and a finite clearance"
            )
        if not 0.0 <= self.restitution <= 1.0:
            raise ModelError(f"wall {self.name}: restitution = {self.restitution:g} must be from 0 to 1")
        if abs(np.linalg.norm(self.normal) - 1.0) > 1e-12:
            raise ModelError(f"wall {self.name}: normal = {list(self.normal)} must have the length 1")


class Impact(NamedTuple):
    """Time (s), wall, closing velocity (m/s) and impulse of the wall (N s)."""

    time: float
    wall: str
    closing: float
    impulse: float


class Bounced(NamedTuple):
    """A motion between walls and its impacts."""

    motion: Motion
    impacts: tuple[Impact, ...]


def solve_bouncing(
    mechanism: Mechanism,
    walls: Sequence[Wall],
    times: Vector,
    tolerance: float = 1e-10,
    start: Start | None = None,
) -> Bounced:
    """Motion at `times` (s, ascending) from the start at the first of them.

    Raises ModelError where it starts beyond a wall, or where bounces become too short to follow.
    """
    if filmed := [force.name for force in mechanism.forces if isinstance(force, LubricatedCam)]:
        raise ModelError(f"contact {filmed[0]}: has an oil film, which flights do not carry; take solve_ida")
    times, space = check_request(times, tolerance), _Space(mechanism, walls)
    begun = start or mechanism.start(float(times[0]))
    y, t, done = np.concatenate([begun.q, begun.v]), float(times[0]), 1
    states, impacts = np.empty((times.size, y.size)), list[Impact]()
    states[0] = y
    space.refuse_overlap(t, y)
    while done < times.size:
        y, struck = space.strike(t, y)
        impacts += struck
        for before, after, between in space.fly(t, y, float(times[-1]), tolerance):
            hit = space.find_impact(before, after, between)
            end = after if hit is None else hit
            while done < times.size and times[done] <= end:
                states[done] = space.project(times[done], between(times[done]))
                done += 1
            if hit is not None:
                t, y = hit, space.project(hit, between(hit))
                break
    name = f"projected DOP853 between impacts, relative tolerance {tolerance:g}"
    return Bounced(complete(mechanism, times, states, name), tuple(impacts))


class _Space:
    """The walls about a mechanism."""

    def __init__(self, mechanism: Mechanism, walls: Sequence[Wall]) -> None:
        self.mechanism, self.walls, self.size = mechanism, walls, 6 * len(mechanism.bodies)
        self.rate, self.project = make_flow(mechanism, self.size)
        self.left: list[Wall] = []  # walls that are touched where a flight begins

    def measure(self, t: float, y: Vector, wall: Wall) -> tuple[float, Vector, Evaluation]:
        """The gap, its gradient G by the velocities, and the equations there."""
        e = self.mechanism.evaluate(t, y[: self.size].copy(), y[self.size :].copy())
        body = self.mechanism.find_body(wall.body)
        arm, normal = e.rotation[body] @ np.asarray(wall.at, float), np.asarray(wall.normal, float)
        gradient, first = np.zeros(self.size), 6 * (body - 1)
        gradient[first : first + 3], gradient[first + 3 : first + 6] = normal, np.cross(arm, normal)
        return float(normal @ (e.position[body] + arm)) + wall.clearance, gradient, e

    def refuse_overlap(self, t: float, y: Vector) -> None:
        for wall in self.walls:
            if (gap := self.measure(t, y, wall)[0]) < -TOUCHING:
                raise ModelError(
                    f"wall {wall.name}: body {wall.body} begins {-gap:.3g} m beyond it; start between the "
                    "walls"
                )

    def fly(self, t: float, y: Vector, end: float, tolerance: float) -> Iterator[tuple[float, float, Any]]:
        """Steps of a flight: their ends and the states between."""
        sizes = np.repeat([COORDINATE, VELOCITY], [self.size, self.size])
        method = DOP853(self.rate, t, y, end, rtol=tolerance, atol=tolerance * sizes)
        while method.status == "running":
            reason = method.step()
            if method.status == "failed":
                q, v = method.y[: self.size], method.y[self.size :]
                raise explain_failure(self.mechanism, method.t, q, v, str(reason))
            yield method.t_old, method.t, method.dense_output()
            self.left = []
            method.y = self.project(method.t, method.y)
            method.f = self.rate(method.t, method.y)

    def find_impact(self, before: float, after: float, between: Any) -> float | None:
        """The first instant of a step at which a gap closes."""
        found = [self._find_closing(wall, before, after, between) for wall in self.walls]
        return min((t for t in found if t is not None), default=None)

    def _find_closing(self, wall: Wall, before: float, after: float, between: Any) -> float | None:
        def gap(t: float) -> float:
            return self.measure(t, between(t), wall)[0]

        def rate(t: float) -> float:
            y = between(t)
            return float(self.measure(t, y, wall)[1] @ y[self.size :])

        looks = np.linspace(before, after, LOOKS + 1)
        first = looks[0]
        if wall in self.left:
            first = self._leave(wall, looks, gap)
        for one, other in zip([first, *looks[1:-1]], looks[1:], strict=True):
            deepest = other
            if gap(other) >= 0.0 and rate(one) < 0.0 < rate(other):
                deepest = float(brentq(rate, one, other, xtol=1e-15, rtol=1e-15))  # it may dip in between
            if gap(deepest) < 0.0:
                return float(brentq(gap, one, deepest, xtol=1e-15, rtol=1e-15) if gap(one) > 0.0 else one)
        return None

    def _leave(self, wall: Wall, looks: Vector, gap: Any) -> float:
        """An instant soon after an impact, at which the gap is open again."""
        share = 0.5
        while share > SHORTEST_BOUNCE:
            soon = float(looks[0] + share * (looks[1] - looks[0]))
            if gap(soon) > TOUCHING:
                return soon
            share *= 0.5
        if gap(looks[1]) > max(0.0, gap(looks[0])):
            return float(looks[1])  # it leaves slowly
        raise self._refuse_short(wall, looks[0])

    def _refuse_short(self, wall: Wall, t: float) -> ModelError:
        return ModelError(
            f"wall {wall.name}: bounces of {wall.body} at t = {t:.9g} s become too short to follow, "
            "and sliding is not; take more restitution or stop before"
        )

    def strike(self, t: float, y: Vector) -> tuple[Vector, list[Impact]]:
        """The state after the impacts on all walls that are touched and closing; the others that are left."""
        gaps = [self.measure(t, y, wall)[:2] for wall in self.walls]
        self.left = [wall for wall, (gap, _) in zip(self.walls, gaps, strict=True) if gap <= TOUCHING]
        impacts = list[Impact]()
        for _ in range(IMPACTS_AT_ONCE):
            closing = [
                wall for wall, (_, gradient) in zip(self.walls, gaps, strict=True)
                if wall in self.left and gradient @ y[self.size :] < 0.0
            ]  # fmt: skip
            if not closing:
                return y, impacts
            y, struck = self.rebound(t, y, closing)
            impacts += struck
        raise self._refuse_short(closing[0], t)

    def rebound(self, t: float, y: Vector, walls: Sequence[Wall]) -> tuple[Vector, list[Impact]]:
        """The state after an impact on walls that close at once."""
        found = [self.measure(t, y, wall) for wall in walls]
        gradients, e = np.array([gradient for _, gradient, _ in found]), found[-1][2]
        v, none = y[self.size :], np.zeros_like(e.held.rate)
        closing = gradients @ v
        # The velocities that the joints leave without an impulse, and those of unit impulses.
        free, _ = solve_saddle(e, e.mass @ v, -e.held.rate)
        units = np.array([solve_saddle(e, gradient, none)[0] for gradient in gradients])
        restitution = np.array([wall.restitution for wall in walls])
        impulses = share_impulses(gradients @ units.T, -restitution * closing - gradients @ free)
        after = np.concatenate([y[: self.size], free + impulses @ units])
        return after, [
            Impact(t, wall.name, -float(speed), float(impulse))
            for wall, speed, impulse in zip(walls, closing, impulses, strict=True)
            if impulse > 0.0
        ]


def share_impulses(admittance: Vector, change: Vector) -> Vector:
    """P >= 0 with W P >= c and P (W P - c) = 0; W (n, n) is the velocities of unit impulses, positive."""
    best, least = np.zeros_like(change), np.inf
    for count in range(1, change.size + 1):
        for chosen in combinations(range(change.size), count):
            trial, at = np.zeros_like(change), list(chosen)
            trial[at] = np.linalg.lstsq(admittance[np.ix_(at, at)], change[at], rcond=1e-12)[0]
            wrong = max(np.max(-trial * np.diag(admittance)), np.max(change - admittance @ trial))
            if wrong < least:
                best, least = trial, wrong
    return np.maximum(best, 0.0)
