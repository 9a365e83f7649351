"""The unknowns of a design, and the limits of the cam itself, which need no cycles."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from models.core.quantities import Vector

from .figures import LEAST, SEPARATION
from .limits import Limit, Model, closing_limit, duration_limit, flank_limit, kinematic_limits
from .slp import Line, Optimum, Problem, maximise
from .train import DesignedTrain
from .wanted import CONFIRMED, Wanted, describe_beyond

# Boxes in which a first lift is looked for that keeps the limits of the cam itself: it needs no cycles.
MOVES = (5e-3, 1.5e-2, 5e-2, 0.15, 0.5, 1.5)
# Weights of the jerk in a first lift; the largest takes 3 % of the area.
SMOOTHINGS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)
# Further starts are in this part of the box.
SPREAD = 0.5


@dataclass(frozen=True)
class Shaping:
    """A train with the limits that its cam must keep. `bounds` are those of the parameters (rows).

    Where the speed of separation is wanted, the last unknown is the logarithm of its factor.
    """

    train: DesignedTrain
    wanted: Wanted
    bounds: Vector
    cam_speed: float
    area0: float
    tell: Callable[[str], None]
    starts: int = 1
    seed: int = 1

    @property
    def stretched(self) -> bool:
        return self.wanted.objective.name == SEPARATION

    @property
    def scale(self) -> Vector:
        """Sizes of the unknowns: the largest lift, the range of each parameter, and that of speeds."""
        lift = float(self.train.lobe.own.s.max())
        stretch = [1.0] * self.stretched
        return np.array([*[lift] * self.train.lobe.count, *np.ptp(self.bounds, axis=1), *stretch])

    def begin(self) -> Vector:
        """The scenario's cam in bumps, with as little less jerk as the limits of the cam itself need: corners
        of its acceleration ring in bumps. Where that is not enough, moved to where it keeps them, no farther
        than needed. Where no lift keeps them, that is told."""
        lobe, given = self.train.lobe, [*self.train.given.values(), *[0.0] * self.stretched]
        for smoothing in SMOOTHINGS:
            x = np.append(lobe.near(smoothing), given)
            if not self.own_excesses(x):
                return x
        x = np.append(lobe.start, given)
        free = self.own_model(x, Line("", 0.0, np.zeros(x.size), x))
        for box in MOVES:
            if (found := maximise(self.enclose(free, x, box), x)).feasible:
                return found.unknowns
        if beyond := describe_beyond(self.own_excesses(found.unknowns)):
            self.tell(f"no lift was found within the limits of the cam; the nearest is beyond {beyond}")
        return found.unknowns

    def own_excesses(self, x: Vector) -> dict[str, float]:
        """The limits of the cam itself that it exceeds, each with the share."""
        lobe = self.train.lobe
        own = self.own_model(x, self.area_line(x))
        excesses = zip(own.limits, own.excesses(x, lobe.curve(x[: lobe.count])), strict=True)
        return {limit.name: float(most) for limit, one in excesses if (most := one.max()) > CONFIRMED}

    def own_model(self, x: Vector, objective: Line) -> Model:
        """Of the cam alone."""
        return Model(
            self.train.lobe, list(self.own_limits(x)), {}, x, self.geometry, self.scale, objective,
            stretched=self.stretched,
        )  # fmt: skip

    def area_line(self, x: Vector) -> Line:
        lobe, gradient = self.train.lobe, np.zeros(x.size)
        gradient[: lobe.count] = lobe.bumps.areas / self.area0
        return Line("least_lift_area", float(gradient @ x), gradient, x, self.wanted.area, LEAST)

    def own_limits(self, x: Vector) -> Iterator[Limit]:
        lobe = self.train.lobe
        base = self.geometry(x).base_radius
        yield from kinematic_limits(self.wanted.sizes, self.cam_speed, base)
        yield closing_limit(lobe.ramps, float(lobe.own.s.max()))
        yield flank_limit(lobe.own)
        if "largest_duration" in self.wanted.sizes:
            yield duration_limit(lobe.angles, self.wanted.sizes["largest_duration"])

    def geometry(self, x: Vector) -> Any:
        """The follower's, with the parameters among the unknowns."""
        geometry, changed = self.train.lobe.kind.geometry, {}
        for name, value in self.train.values(x).items():
            part, _, parameter = name.partition(".")
            field = {"follower_radius": "radius"}.get(parameter, parameter)
            if part == self.train.cam and field in geometry._fields:
                changed[field] = value
        return geometry._replace(**changed)

    def solve(self, model: Model, x: Vector, box: float, starts: int) -> Optimum:
        """The best optimum of the model within the box around `x`, from there and from random corners of what
        the limits of the cam itself allow in a part of the box."""
        problem, random = self.enclose(model, x, box), np.random.default_rng(self.seed)
        places = [x, *(self.draw(x, SPREAD * box, random) for _ in range(starts - 1))]
        return max((maximise(problem, one) for one in places), key=lambda one: one.local.merit)

    def draw(self, x: Vector, box: float, random: np.random.Generator) -> Vector:
        """The farthest place in a random direction within the box that the limits of the cam itself allow."""
        direction = random.normal(size=x.size)
        direction /= np.linalg.norm(direction) * self.scale
        return maximise(self.enclose(self.own_model(x, Line("", 0.0, direction, x)), x, box), x).unknowns

    def enclose(self, model: Model, x: Vector, box: float) -> Problem:
        """The model within a box around `x`, and within the bounds of the parameters."""
        reach = box * self.scale
        low, high = x - reach, x + reach
        count = self.train.lobe.count
        among = slice(count, count + len(self.bounds))
        low[among] = np.maximum(low[among], self.bounds[:, 0])
        high[among] = np.minimum(high[among], self.bounds[:, 1])
        return Problem(model.evaluate, low, high, self.scale)
