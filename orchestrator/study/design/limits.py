"""Limits of a cam and of its train, as excesses over the event's angles: at most 0 where a limit holds.

Lift, velocity, acceleration and jerk are linear in the coefficients. What a limit makes of them is
differentiated by central differences in s, s', s'', s''' and in the load, at every angle, and by the chain
rule in the unknowns.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.core.quantities import Vector
from models.valve_train.followers.shape import find_least_radius

from .answers import Answer, find_dips
from .lobe import FINE, Curve, Lobe, Touch
from .slp import Line, Local, Rows

# Relative steps of differences.
STEP = 1e-6
# The least lift (m) and derivative that a step is a part of.
LEAST = 1e-3
# A cam whose contact would stand still has a cusp: it moves by at least this part of the base radius.
CUSP = 0.02
# The part of the event about its middle in which the lift has one nose.
NOSE = 1.0 / 3.0
# Of the largest velocity, what counts as all of it against the way of a flank.
SLOW = 0.02
# The lift (m) at which durations count.
HEIGHT = 1e-3
# The scale (m) of smaller gaps; that of an own cam whose coils clash is below 0.
SMALL_GAP = 1e-4
# Of the entraining velocity, in formulas of films.
POWER = 0.7


class State(NamedTuple):
    """Lift and contact along the event, with the least and largest values of the limit's column."""

    curve: Curve
    touch: Touch
    low: Vector
    high: Vector


@dataclass(frozen=True)
class Limit:
    """A limit of that name and size. `excess(state, size)` is without unit. `column` of the answer at `speed`
    (rad/s) is the one that it needs. `by_size`: derivative of the excess by the size, as a share of it, where
    that is not the one of `excess`. `rare` as in `Rows`."""

    name: str
    size: float
    excess: Callable[[State, float], Vector]
    column: str = ""
    speed: float = 0.0
    by_size: Vector | None = None
    rare: bool = False


def _most(value: Callable[[State], Vector]) -> Callable[[State, float], Vector]:
    return lambda state, size: value(state) / size - 1.0


def _most_values(speed: float) -> dict[str, Callable[[State], Vector]]:
    """What limits of the cam alone bound from above; `speed` of the cam (rad/s) turns m/rad2 into m/s2."""
    square, cube = speed**2, speed**3
    return {
        "largest_lift": lambda q: q.curve.s,
        "largest_velocity": lambda q: np.abs(q.curve.ds) * speed,
        "largest_acceleration": lambda q: q.curve.dds * square,
        "largest_deceleration": lambda q: -q.curve.dds * square,
        "largest_jerk": lambda q: np.abs(q.curve.ddds) * cube,
        "largest_pressure_angle": lambda q: np.abs(q.touch.pressure_angle),
        "largest_offset": lambda q: np.abs(q.touch.arm),
    }


def find_sizes(lobe: Lobe, curve: Curve, geometry: Any, speed: float) -> dict[str, float]:
    """What a lift has of the limits of the cam itself, in SI units, at a speed of the cam (rad/s)."""
    touch, none = lobe.touch(curve, geometry), np.empty(0)
    here, bend = State(curve, touch, none, none), touch.turn / touch.cam_rate
    with np.errstate(divide="ignore"):  # straight flanks
        radius = touch.cam_rate / touch.turn
    return {name: float(value(here).max()) for name, value in _most_values(speed).items()} | {
        "least_lift": float(curve.s.max()),
        "least_radius": float(radius[find_least_radius(radius, touch.cam_rate)]),
        "wheel_radius": float(-1.0 / bend.min()) if bend.min() < 0.0 else 1e3,
        "largest_nose_radius": float(1.0 / max(bend[is_middle(bend.size)].min(), 1e-3)),
        "largest_duration": _find_duration(lobe.angles, curve.s),
    }


def _find_duration(angles: Vector, s: Vector) -> float:
    """Four times the larger cam angle from the middle of the event to a lift of HEIGHT: that of the crank."""
    rows = np.flatnonzero(s >= HEIGHT)
    if not rows.size:
        return 0.0
    first, last = max(1, int(rows[0])), min(s.size - 2, int(rows[-1]))
    ends = (
        np.interp(HEIGHT, s[first - 1 : first + 1], angles[first - 1 : first + 1]),
        np.interp(-HEIGHT, -s[last : last + 2], angles[last : last + 2]),
    )
    return 4.0 * float(np.abs(np.array(ends) - 0.5 * (angles[0] + angles[-1])).max())


def is_middle(rows: int) -> NDArray[np.bool_]:
    """Whether a row is in the part of the event with the nose."""
    return np.asarray(np.abs(np.linspace(-1.0, 1.0, rows)) <= NOSE)


def kinematic_limits(sizes: Mapping[str, float], speed: float, base_radius: float) -> Iterator[Limit]:
    """Those of the cam alone, which turns at a speed (rad/s)."""
    for name, value in _most_values(speed).items():
        if name in sizes:
            yield Limit(name, sizes[name], _most(value))
    others: dict[str, Callable[[State, float], Vector]] = {
        "least_lift": lambda q, size: np.where(q.curve.s < q.curve.s.max(), -1.0, 1.0 - q.curve.s / size),
        "least_radius": lambda q, size: (q.touch.turn * size - q.touch.cam_rate) / base_radius,
        "wheel_radius": lambda q, size: -(q.touch.turn * size + q.touch.cam_rate) / base_radius,
        "largest_nose_radius": lambda q, size: np.where(
            is_middle(q.curve.s.size), (q.touch.cam_rate - q.touch.turn * size) / base_radius, -1.0
        ),
    }
    for name, excess in others.items():
        if name in sizes:
            yield Limit(name, sizes[name], excess)
    yield Limit("undercut", CUSP, lambda q, size: size - q.touch.cam_rate / base_radius)

    def rises(state: State, size: float) -> Vector:
        return np.where(is_middle(state.curve.dds.size), state.curve.dds / base_radius - size, -1.0)

    yield Limit("dip of the nose", 0.0, rises)


def closing_limit(ramps: Curve, largest: float) -> Limit:
    """The event adds to its ramps and takes nothing from them."""
    return Limit("lift of the ramps", 0.0, lambda q, size: (ramps.s - q.curve.s) / largest - size)


def flank_limit(own: Curve) -> Limit:
    """The lift falls at no angle before the nose and rises at none behind it, or not faster than that of the
    scenario's `own` cam: outside the middle third, as the limit of dips holds in it."""
    rows, middle, nose = np.arange(own.s.size), np.flatnonzero(is_middle(own.s.size)), int(np.argmax(own.s))
    # Against the way of the flank: -1 where the lift is to rise, 1 where it is to fall.
    against = 1.0 * (rows > max(nose, middle[-1])) - 1.0 * (rows < min(nose, middle[0]))
    most, scale = max(0.0, float((against * own.ds).max())), SLOW * float(np.abs(own.ds).max())

    def excess(state: State, size: float) -> Vector:
        return np.where(against == 0.0, -1.0, (against * state.curve.ds - most) / scale - size)

    return Limit("fall of a flank", 0.0, excess, rare=True)


def duration_limit(angles: Vector, most: float) -> Limit:
    """The cam lifts by less than HEIGHT beyond a crank angle (rad) about the middle of the event."""
    from_middle = angles - 0.5 * (angles[0] + angles[-1])

    def excess(state: State, size: float) -> Vector:
        step = np.copysign(0.25 * size, from_middle) - from_middle
        lift = state.curve.s + state.curve.ds * step
        return np.where(np.abs(step) <= angles[1] - angles[0], lift / HEIGHT - 1.0, -1.0)

    return Limit("largest_duration", most, excess)


def load_limit(
    name: str, column: str, speed: float, least: float, scale: float, lifted: Vector,
    slower: Vector | None = None,
) -> Limit:  # fmt: skip
    """A contact keeps at least this load (N) while the cam lifts.

    With `slower`, what the loads change by for a share of the speed, the limit's size is the speed.
    """

    def excess(state: State, size: float) -> Vector:
        return np.where(lifted, (size - state.low) / scale, -1.0)

    by_size = None if slower is None else np.where(lifted, -slower / scale, 0.0)
    return Limit(name, least, excess, column, speed, by_size)


def gap_limit(name: str, column: str, speed: float, least: float) -> Limit:
    """Springs keep at least this travel (m) to coil bind."""
    scale = max(abs(least), SMALL_GAP)
    return Limit(name, least, lambda q, size: (size - q.low) / scale, column, speed)


def pressure_limit(
    name: str, column: str, speed: float, most: float, stiffness: float, arc: float | None
) -> Limit:
    """Hertz's pressure: p^2 = `stiffness` W (1/rho + `arc`) of the cam's contact with a follower of that
    curvature (1/m); p^2 = `stiffness` W of a contact whose curvature stays as it is (None)."""

    def excess(state: State, size: float) -> Vector:
        bend = 1.0 if arc is None else state.touch.turn / state.touch.cam_rate + arc
        return stiffness * state.high * bend / size**2 - 1.0

    return Limit(name, most, excess, column, speed)


def film_limits(
    at: str, column: str, speed: float, least: float, ratios: Vector, entraining: Vector
) -> Iterator[Limit]:
    """The contact keeps at least this film over roughness, of which `ratios` are a cycle's (nan: none).

    Around a reversal of the entraining velocity (m/rad, of the cycle's cam) only the thinnest place counts:
    it may move without harm. Elsewhere the film also follows the velocity of the new cam, by POWER, so that
    no new reversal is made: there no tangent foresees it. These are limits of their own: both are equal at
    the cycle's cam, where the lower one has no derivative.
    """
    thin = find_dips(ratios)
    turns = np.diff(np.sign(entraining), append=np.sign(entraining[-1])) != 0.0
    steady = np.isfinite(ratios) & (np.convolve(turns, np.ones(2 * FINE + 1), "same") < 0.5)
    before = np.where(steady, entraining, 1.0)

    def follow(state: State, size: float) -> Vector:
        share = np.where(steady, np.maximum(0.0, state.touch.entraining / before), 1.0)
        return np.where(steady, 1.0 - ratios * share**POWER / size, -1.0)

    yield Limit(
        f"film ratio {at}",
        least,
        lambda q, size: np.where(thin | steady, 1.0 - q.low / size, -1.0),
        column,
        speed,
    )
    yield Limit(f"film ratio by velocity {at}", least, follow)


@dataclass(frozen=True)
class Model:
    """What the optimiser sees: a lobe, its limits, and the answers of cycles at a place.

    `geometry` is the follower's with the parameters among the unknowns; `lines` are limits of figures. Where
    `stretched`, the last unknown is the logarithm of a factor of the speeds of those limits whose `by_size`
    is that of a speed.
    """

    lobe: Lobe
    limits: Sequence[Limit]
    answers: Mapping[float, Answer]
    place: Vector
    geometry: Callable[[Vector], Any]
    scale: Vector
    objective: Line
    lines: Sequence[Line] = ()
    stretched: bool = False

    def states(self, unknowns: Vector, curve: Curve, shift: float = 0.0) -> Iterator[State]:
        """The state that each limit sees, with its column moved by `shift` of its largest value."""
        touch = self.lobe.touch(curve, self.geometry(unknowns))
        for limit in self.limits:
            low, high = self._column(limit, unknowns)
            if shift and low.size:
                moved = shift * max(1e-12, float(np.abs(high).max()))
                low, high = low + moved, high + moved
            yield State(curve, touch, low, high)

    def _column(self, limit: Limit, unknowns: Vector) -> tuple[Vector, Vector]:
        if not limit.column:
            return np.empty(0), np.empty(0)
        answer = self.answers[limit.speed]
        change = answer.gradients[limit.column] @ (unknowns - self.place)
        column = answer.columns[limit.column]
        return column.low + change, column.high + change

    def excesses(self, unknowns: Vector, curve: Curve, shift: float = 0.0) -> list[Vector]:
        pairs = zip(self.limits, self.states(unknowns, curve, shift), strict=True)
        return [np.asarray(limit.excess(state, limit.size)) for limit, state in pairs]

    def evaluate(self, unknowns: Vector) -> Local:
        """Objective and limits with their derivatives."""
        count, curve = self.lobe.count, self.lobe.curve(unknowns[: self.lobe.count])
        base = self.excesses(unknowns, curve)
        gradients = [np.zeros((one.size, unknowns.size)) for one in base]
        for which, matrix in enumerate(self.lobe.matrices):
            step = STEP * max(LEAST, float(np.abs(curve[which]).max()))
            near = [
                self.excesses(unknowns, curve._replace(**{Curve._fields[which]: curve[which] + side * step}))
                for side in (-1.0, 1.0)
            ]
            for gradient, before, after in zip(gradients, *near, strict=True):
                gradient[:, :count] += ((after - before) / (2.0 * step))[:, None] * matrix
        self._add_columns(unknowns, curve, base, gradients)
        self._add_parameters(unknowns, curve, gradients)
        rows = [line.rows(unknowns) for line in self.lines]
        states = self.states(unknowns, curve)
        for limit, state, excess, gradient in zip(self.limits, states, base, gradients, strict=True):
            by_size = limit.by_size
            if by_size is None:
                by_size = (limit.excess(state, limit.size * (1.0 + STEP)) - excess) / STEP
            elif self.stretched:
                excess += by_size * (unknowns[-1] - self.place[-1])
                gradient[:, -1] += by_size
            rows.append(Rows(limit.name, excess, gradient, by_size, limit.rare))
        return Local(self.objective.at(unknowns), self.objective.gradient, rows)

    def _add_columns(
        self, unknowns: Vector, curve: Curve, base: Sequence[Vector], gradients: Sequence[Vector]
    ) -> None:
        moved = self.excesses(unknowns, curve, STEP)
        for limit, before, after, gradient in zip(self.limits, base, moved, gradients, strict=True):
            if limit.column:
                _, high = self._column(limit, unknowns)
                step = STEP * max(1e-12, float(np.abs(high).max()))
                answer = self.answers[limit.speed].gradients[limit.column]
                gradient += ((after - before) / step)[:, None] * answer

    def _add_parameters(self, unknowns: Vector, curve: Curve, gradients: Sequence[Vector]) -> None:
        """By the geometry that parameters change; what they do to loads is in the columns."""
        for which in range(self.lobe.count, unknowns.size - self.stretched):
            step = STEP * self.scale[which]
            near = []
            for side in (-1.0, 1.0):
                changed = unknowns.copy()
                changed[which] += side * step
                touch = self.lobe.touch(curve, self.geometry(changed))
                near.append(
                    [
                        limit.excess(state._replace(touch=touch), limit.size)
                        for limit, state in zip(self.limits, self.states(unknowns, curve), strict=True)
                    ]
                )
            for gradient, before, after in zip(gradients, *near, strict=True):
                gradient[:, which] += (after - before) / (2.0 * step)
