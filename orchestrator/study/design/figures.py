"""Figures of merit in a design: what is asked of them, and their limits as lines."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from models.core.quantities import Vector
from models.core.system import ModelError

from ...analyses import Result
from ...assessment.figures_of_merit import measure
from ...assessment.motion import Found, Motion
from ...errors import MistakeError, one_of
from .brief import FIGURES, FREE, LANDINGS, OWN, Brief, Size
from .lobe import Lobe
from .slp import Bow, Line

AREA, SEPARATION = "lift_area", "separation_speed"
MOST, LEAST = 1.0, -1.0
# The scale of a figure whose limit is less: a bounce of less than a half per cent of it, 0.5 µm, is none.
SMALL = {"bounce": 1e-4}
TINY = 1e-12
# From a line between two rows to the angle of a lift, where bumps are smooth: to rounding in few steps.
NEWTON = 3


class Bound(NamedTuple):
    """A figure "part.name" and its size, which is the most (side 1) or least (-1) one."""

    name: str
    side: float
    size: float

    @property
    def figure(self) -> str:
        return self.name.rpartition(".")[2]

    @property
    def lands(self) -> bool:
        """Whether it is of a landing, which is limited up to the speed of separation."""
        return self.figure in LANDINGS

    @property
    def scale(self) -> float:
        return max(abs(self.size), SMALL.get(self.figure, TINY))


class Objective(NamedTuple):
    """AREA, SEPARATION or a figure "part.name" with its values by speed (rad/s) before; sign -1: less is
    better."""

    name: str = AREA
    sign: float = 1.0
    before: Mapping[float, float] = {}

    @property
    def is_figure(self) -> bool:
        return self.name not in (AREA, SEPARATION)

    def weigh(self, values: Mapping[float, float]) -> float:
        """1 where the figure is as before, more where it is better; the mean of the speeds."""
        shares = [(values[speed] - own) / abs(own) for speed, own in self.before.items()]
        return 1.0 + self.sign * sum(shares) / len(shares)


def list_bounds(
    brief: Brief, known: Mapping[str, Result], own: Callable[[str, float], float]
) -> Iterator[Bound]:
    """What the brief asks of figures; `own` gives the largest or least one of the scenario's own cam, or a
    ModelError where it has none: as a valve without a seat."""
    for limit, (figure, side) in FIGURES.items():
        asked: Size = getattr(brief.limits, limit)
        names = [name for name in known if name.endswith(f".{figure}")]
        given = limit in brief.limits.model_fields_set
        if asked != FREE and given and not names:
            raise MistakeError(f"limits.{limit}: no part of the scenario has the figure {figure}")
        for name in names if asked != FREE else ():
            try:
                yield Bound(name, side, own(name, side) if asked == OWN else float(asked))
            except ModelError:
                if given:
                    raise
    for name, ends in brief.figures.items():
        _check(f"figures.{name}", name, known)
        for side, end in ((LEAST, ends.least), (MOST, ends.most)):
            if end is not None:
                value = own(name, side)  # also refuses a figure that the cycles have not
                size = value if end == OWN else ends.read(end, name, known[name])
                yield Bound(name, side, size)


def find_objective(
    brief: Brief, known: Mapping[str, Result], own: Callable[[str, float], float], speeds: Sequence[float]
) -> Objective:
    """What the brief wants; `own` gives a figure of the scenario's own cam at a speed (rad/s)."""
    name = brief.minimise or brief.maximise or AREA
    sign = -1.0 if brief.minimise else 1.0
    key = "minimise" if brief.minimise else "maximise"
    if name in (AREA, SEPARATION):
        if brief.minimise:
            raise MistakeError(f"minimise = {name}: is to be maximised")
        if name == SEPARATION and brief.limits.separation_speed == FREE:
            raise MistakeError(f'maximise = {name}: needs limits.separation_speed, which is "free"')
        return Objective(name)
    _check(key, name, known)
    before = {speed: own(name, speed) for speed in speeds}
    if not all(before.values()):
        raise MistakeError(
            f"{key} = {name}: is 0 of the scenario's own cam; nothing can be better by a share"
        )
    return Objective(name, sign, before)


def _check(key: str, name: str, known: Mapping[str, Result]) -> None:
    if name not in known:
        raise MistakeError(f"{key}: {one_of(sorted([*known, AREA, SEPARATION]), name)}")


def read_figures(motion: Motion, names: Sequence[str]) -> dict[str, Found]:
    """By "part.name"; ModelError for one that the motion has not."""
    found = {f"{part}.{name}": value for part, name, _, value in measure(motion, names)}
    if missing := [name for name in names if not math.isfinite(found[name].value)]:
        raise ModelError(f"{', '.join(missing)}: no value in the cycle")
    return {name: found[name] for name in names}


def bound_lines(
    bounds: Sequence[Bound], found: Mapping[str, Found], slopes: Mapping[str, Vector], place: Vector,
    at: str, angle: Callable[[int | None], float], lobe: Lobe,
) -> Iterator[Line]:  # fmt: skip
    """The bounds of figures that were found, as linear functions around a place; velocities of landings with
    what the cam adds to that."""
    for bound in bounds:
        if one := found.get(name := bound.name):
            where, slope = angle(one.row), slopes[name]
            line = Line(f"{name} {at}", one.value, slope, place, bound.size, bound.side, where, bound.scale)
            lands = bound.figure == "seating_velocity"
            yield line._replace(bow=bow_landing(lobe, place, where, one.value)) if lands else line


def bow_landing(lobe: Lobe, place: Vector, angle: float, velocity: float) -> Bow:
    """What a velocity of landing, found at a cam angle (rad) with the lift at `place`, is beyond its tangent:
    a valve lands at one lift of the cam, and with its velocity there, which changes along a ramp."""
    count = lobe.count

    def trace(x: Vector, at: float) -> tuple[Vector, list[Vector]]:
        ramp, rows = lobe.ramp(at), [lobe.bumps.at(np.array([at]), nu)[0] for nu in range(3)]
        return np.array([r + row @ x[:count] for r, row in zip(ramp, rows, strict=True)]), rows

    def fall(x: Vector, lift: float) -> tuple[float, Vector]:
        """The slope of the closing flank at a lift, with its derivatives."""
        s = lobe.curve(x[:count]).s
        last, gradient = int(np.flatnonzero(s > lift)[-1]), np.zeros(x.size)
        step = (s[last] - lift) / (s[last] - s[last + 1])
        at = float(lobe.angles[last] + step * (lobe.angles[last + 1] - lobe.angles[last]))
        for _ in range(NEWTON):
            (there, ds, _), _ = trace(x, at)
            at = float(np.clip(at - (there - lift) / ds, lobe.angles[last], lobe.angles[last + 1]))
        (_, ds, dds), rows = trace(x, at)
        gradient[:count] = rows[1] - rows[0] * dds / ds
        return float(ds), gradient

    nose = lobe.angles[int(np.argmax(lobe.curve(place[:count]).s))]
    if not nose < angle < lobe.angles[-1]:
        return lambda x: (0.0, np.zeros(x.size))
    lift = float(trace(place, angle)[0][0])
    own, tangent = fall(place, lift)
    share = velocity / own

    def bow(x: Vector) -> tuple[float, Vector]:
        s = lobe.curve(x[:count]).s
        if not s[-1] < lift < s.max():  # it lands on the ramp
            return 0.0, np.zeros(x.size)
        there, gradient = fall(x, lift)
        return share * (there - own - float(tangent @ (x - place))), share * (gradient - tangent)

    return bow
