"""The search for the best cam: cycles of the train, an optimum of what they say, and cycles again.

The answers of the train's cycles to bumps of the lift make a linear model of its loads, with its vibrations.
The optimum within a box around the last lift is taken where the cycles confirm it; else the box shrinks.
A contact that is lost answers nothing: loads at a speed of separation are then continued from the next lower
speed that keeps contact, by the square of the speed.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from models.core.quantities import Vector
from models.core.system import ModelError
from models.monolithic.cycle import Cycle

from ...assessment.figures_of_merit import CONTACT
from ...assessment.motion import Part
from ..speeds.separation import bisect_separation, is_separated
from ..speeds.subject import to_motion
from .limits import (
    Limit,
    Model,
    closing_limit,
    gap_limit,
    kinematic_limits,
    load_limit,
    pressure_limit,
)
from .slp import Active, Optimum, Problem, maximise
from .train import Answer, Column, DesignedTrain

# Of the largest lift: the box of the coefficients at first, at most, and where the search ends.
BOX, LARGEST, SMALLEST = 0.05, 0.15, 2e-3
SHORTER, MOST_ROUNDS = 0.35, 12
# A round that adds less of the objective is the last.
LITTLE = 5e-4
# Further starts differ by up to this part of the box.
SPREAD = 0.5
# Where contact is lost, lower speeds are tried in such steps.
LOWER, MOST_LOWER = 0.97, 8
# A share of speed counts as this share of load.
SEVERE = 2.0
RPM = 30.0 / math.pi
# A speed of separation is found to this part of it.
CLOSE = 1e-3
# A limit of loads is met with this share of their scale to spare, for what the model leaves out.
SPARE = 0.004
# Of a limit by cycles, that a confirmed lift may exceed it.
CONFIRMED = 5e-3


@dataclass(frozen=True)
class Wanted:
    """Limits in SI units: sizes of the cam's own, of pressures by contact, of gaps by spring, the least load
    at all `speeds` (rad/s), and the `kept` ones up to which contact is kept, the highest first."""

    sizes: Mapping[str, float]
    pressures: Mapping[str, float]
    gaps: Mapping[str, float]
    least_load: float
    speeds: Sequence[float]
    kept: Sequence[float]


class Seen(NamedTuple):
    """A cycle that stands for another speed (rad/s), at which contact is lost."""

    near: float
    cycle: Cycle


class Found(NamedTuple):
    """Unknowns with the objective over that of the scenario's cam, and the limits that their cycles exceed,
    each with the share."""

    unknowns: Vector
    objective: float
    beyond: Mapping[str, float]

    @property
    def violation(self) -> float:
        return sum(self.beyond.values())

    @property
    def rank(self) -> float:
        """Those that keep the limits go before others; these by their violation."""
        return self.objective if not self.beyond else -self.violation


class Improved(NamedTuple):
    """The best that cycles confirm, and what holds it: active limits, with the cam angles (rad) where."""

    found: Found
    active: Sequence[tuple[Active, float]]


@dataclass(frozen=True)
class Search:
    """A train with the limits that its cam must keep. `bounds` are those of the parameters (rows)."""

    train: DesignedTrain
    wanted: Wanted
    bounds: Vector
    cam_speed: float
    area0: float
    tell: Callable[[str], None]
    starts: int = 1
    seed: int = 1

    @property
    def contacts(self) -> list[str]:
        return self.train.train.contacts

    @property
    def columns(self) -> list[str]:
        outputs = [f"{name}.{kind}" for name in self.contacts for kind in ("load", "maximum_pressure")]
        return [*outputs, *(f"{name}.least_gap" for name in self.wanted.gaps)]

    @property
    def all_speeds(self) -> list[float]:
        return sorted({*self.wanted.speeds, *self.wanted.kept})

    @property
    def scale(self) -> Vector:
        """Sizes of the unknowns: the largest lift, and the range of each parameter."""
        lift = float(self.train.lobe.own.s.max())
        return np.append(np.full(self.train.lobe.count, lift), np.ptp(self.bounds, axis=1))

    def is_lost(self, cycle: Cycle) -> bool:
        return is_separated(to_motion(cycle, self.train.subject.flywheel), "lost")

    def begin(self) -> Vector:
        """The scenario's cam in bumps, moved by little to where it keeps the limits of the cam itself."""
        x = np.append(self.train.lobe.start, list(self.train.given.values()))
        limits = list(self.own_limits(x))
        free = Model(self.train.lobe, limits, {}, x, self.geometry, self.scale, math.inf)
        nearest = (self.solve(free, x, box, 1) for box in (0.1 * BOX, 0.3 * BOX, BOX))
        return next((found for found in nearest if found.feasible), self.solve(free, x, BOX, 1)).unknowns

    def improve(self, start: Vector, best: Callable[[Found], None]) -> Improved:
        """Rounds of cycles and optima from `start`; `best` hears of each better one that cycles confirm."""
        x, box, found, gained = start, BOX, None, True
        model: Model | None = None
        for number in range(MOST_ROUNDS):
            try:
                seen = self.look(x)
            except ModelError as error:
                if found is None or model is None:
                    raise
                self.tell(f"round {number}: no cycles ({error}); a smaller step is tried")
                box *= SHORTER
                x = self.solve(model, found.unknowns, box, 1).unknowns
                continue
            here = self.judge(x, seen)
            self.tell(f"round {number}: {describe(here)}")
            if found is None or here.rank > found.rank:
                gained = found is None or here.rank - found.rank > LITTLE
                box = box if found is None else min(LARGEST, 1.5 * box)
                found = here
                best(found)
                model = self.model(x, dict(self.list_answers(x, seen)))
            else:
                box *= SHORTER
            if not gained or box < SMALLEST:
                break
            assert model is not None
            x = self.solve(model, found.unknowns, box, self.starts if number == 0 else 1).unknowns
        assert found is not None
        assert model is not None
        # What holds the cam that was found, by its own cycles.
        last = self.solve(model, found.unknowns, max(box, SMALLEST), 1)
        angles = self.train.lobe.angles
        return Improved(found, [(one, float(angles[one.row])) for one in last.active])

    def look(self, x: Vector) -> dict[float, Seen]:
        """The cycles at all speeds; where contact is lost, those of the next lower speeds that keep it."""
        found = {}
        for speed in self.all_speeds:
            near, cycle = speed, self.cycle(x, speed)
            for _ in range(MOST_LOWER * (speed in self.wanted.kept)):
                if not self.is_lost(cycle):
                    break
                near *= LOWER
                cycle = self.cycle(x, near)
            found[speed] = Seen(near, cycle)
        return found

    def cycle(self, x: Vector, speed: float) -> Cycle:
        found = self.train.simulate(x, speed)
        if not self.is_lost(found):
            self.train.begin_with(found, speed)
        return found

    def judge(self, x: Vector, seen: Mapping[float, Seen]) -> Found:
        """What the cycles say of the limits, and the cam of its own."""
        excesses: dict[str, float] = {}
        for speed, (near, cycle) in seen.items():
            at = f"at {speed * RPM:.0f} r/min"
            if near < speed:
                excesses[f"separation {at}"] = SEVERE * (1.0 - near / speed)
            motion = to_motion(cycle, self.train.subject.flywheel)
            for name in self.contacts:
                part = Part(motion, name)
                if (least := self.wanted.least_load) > 0.0:
                    load = CONTACT["least_load"][1](part).value
                    excesses[f"least load of {name} {at}"] = 1.0 - load / least
                if name in self.wanted.pressures:
                    pressure = CONTACT["peak_pressure"][1](part).value
                    excesses[f"pressure in {name} {at}"] = pressure / self.wanted.pressures[name] - 1.0
            for name, least in self.wanted.gaps.items():
                gap = float(cycle[f"{name}.least_gap"].min())
                excesses[f"gap of {name} {at}"] = (least - gap) / max(abs(least), 1e-4)
        lobe = self.train.lobe
        own = Model(lobe, list(self.own_limits(x)), {}, x, self.geometry, self.scale, self.area0)
        curve = lobe.curve(x[: lobe.count])
        for limit, excess in zip(own.limits, own.excesses(x, curve), strict=True):
            excesses[limit.name] = float(excess.max())
        beyond = {name: excess for name, excess in excesses.items() if excess > CONFIRMED}
        area = float(lobe.bumps.areas @ x[: lobe.count]) / self.area0
        return Found(x, area, beyond)

    def list_answers(self, x: Vector, seen: Mapping[float, Seen]) -> Iterator[tuple[float, Answer]]:
        """By speed; those of lost contact are continued from lower speeds."""
        lowest: Answer | None = None
        for speed, (near, cycle) in seen.items():
            answer = self.train.answer(x, cycle, near, self.columns)
            lowest = lowest or answer
            yield speed, answer if near == speed else _continue(lowest, answer, speed)

    def own_limits(self, x: Vector) -> Iterator[Limit]:
        lobe = self.train.lobe
        base = self.geometry(x).base_radius
        yield from kinematic_limits(self.wanted.sizes, self.cam_speed, base)
        yield closing_limit(lobe.ramps, float(lobe.own.s.max()))

    def geometry(self, x: Vector) -> Any:
        """The follower's, with the parameters among the unknowns."""
        geometry, count = self.train.lobe.kind.geometry, self.train.lobe.count
        changed = {}
        for name, value in zip(self.train.parameters, x[count:], strict=True):
            part, _, parameter = name.partition(".")
            field = {"follower_radius": "radius"}.get(parameter, parameter)
            if part == self.train.cam and field in geometry._fields:
                changed[field] = float(value)
        return geometry._replace(**changed)

    def model(self, x: Vector, answers: Mapping[float, Answer]) -> Model:
        """The limits, with the answers around `x`."""
        lobe, limits = self.train.lobe, list(self.own_limits(x))
        curve = lobe.curve(x[: lobe.count])
        lifted = self.train.lifted(curve.s)
        geometry = self.geometry(x)
        touch = lobe.touch(curve, geometry)
        arc = 1.0 / geometry.radius if hasattr(geometry, "radius") else 0.0
        first = next(iter(self.contacts), "")
        slowest = answers[min(answers)]
        for speed, answer in answers.items():
            at = f"at {speed * RPM:.0f} r/min"
            for name in self.contacts:
                load = answer.columns[f"{name}.load"]
                scale = float(np.max(load.high))
                least = self.wanted.least_load
                kept = speed in self.wanted.kept
                if kept or least > 0.0:
                    size, column = least + SPARE * scale, f"{name}.load"
                    change = _by_speed(slowest, answer, column) if kept and speed > slowest.speed else None
                    word = f"{'separation' if kept else 'least load'} of {name} {at}"
                    limits.append(load_limit(word, column, speed, size, scale, lifted, change))
                if name in self.wanted.pressures:
                    own = name == first
                    bend = touch.turn / touch.cam_rate + arc if own else np.ones(curve.s.size)
                    pressure = answer.columns[f"{name}.maximum_pressure"]
                    strong = load.high * bend
                    row = int(np.argmax(np.where(load.high > 0.2 * scale, strong, 0.0)))
                    stiffness = float(pressure.high[row] ** 2 / strong[row])
                    limits.append(
                        pressure_limit(
                            f"pressure in {name} {at}",
                            f"{name}.load",
                            speed,
                            self.wanted.pressures[name],
                            stiffness,
                            arc if own else None,
                        )
                    )
            for name, gap in self.wanted.gaps.items():
                limits.append(gap_limit(f"gap of {name} {at}", f"{name}.least_gap", speed, gap))
        return Model(lobe, limits, answers, x.copy(), self.geometry, self.scale, self.area0)

    def solve(self, model: Model, x: Vector, box: float, starts: int) -> Optimum:
        """The best optimum of the model within the box around `x`, from `starts` places in it."""
        reach = box * self.scale
        low, high = x - reach, x + reach
        count = self.train.lobe.count
        low[count:] = np.maximum(low[count:], self.bounds[:, 0])
        high[count:] = np.minimum(high[count:], self.bounds[:, 1])
        problem = Problem(model.evaluate, low, high, self.scale)
        places = np.random.default_rng(self.seed).uniform(-1.0, 1.0, (starts, x.size)) * SPREAD * reach
        places[0] = 0.0
        return max((maximise(problem, x + one) for one in places), key=lambda one: one.local.merit)


def describe(found: Found) -> str:
    """In words."""
    area = f"area {100.0 * (found.objective - 1.0):+.2f} %"
    beyond = (f"{name} by {100.0 * share:.2g} %" for name, share in found.beyond.items())
    return f"{area}; beyond limits: {', '.join(beyond)}" if found.beyond else f"{area}, all limits kept"


def _by_speed(low: Answer, high: Answer, column: str) -> Vector:
    """Derivative of a column at the higher speed by its logarithm, as of a + b speed^2."""
    share = 2.0 * high.speed**2 / (high.speed**2 - low.speed**2)
    return np.asarray(share * (high.columns[column].low - low.columns[column].low))


def _continue(low: Answer, high: Answer, speed: float) -> Answer:
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


def find_separation(
    is_lost: Callable[[float], bool], low: float, high: float, steps: int = 12
) -> float | None:
    """The lowest of `steps` speeds (rad/s) from `low` to `high` at which contact is lost, found closer
    between it and the one before; None where it is kept at all of them."""
    kept = None
    for speed in np.geomspace(low, high, steps):
        if is_lost(float(speed)):
            return float(speed) if kept is None else bisect_separation(is_lost, kept, float(speed), CLOSE)
        kept = float(speed)
    return None
