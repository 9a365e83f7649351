"""Figures of merit in a design: what is asked of them, and their limits as lines."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

from models.core.quantities import Vector
from models.core.system import ModelError

from ...analyses import Result
from ...assessment.figures_of_merit import measure
from ...assessment.motion import Found, Motion
from ...errors import MistakeError, one_of
from .brief import FIGURES, FREE, OWN, Brief, Size
from .slp import Line

AREA, SEPARATION = "lift_area", "separation_speed"
MOST, LEAST = 1.0, -1.0


class Bound(NamedTuple):
    """A figure "part.name" and its size, which is the most (side 1) or least (-1) one."""

    name: str
    side: float
    size: float


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
    """What the brief asks of figures; `own` gives the largest or least one of the scenario's own cam."""
    for limit, (figure, side) in FIGURES.items():
        asked: Size = getattr(brief.limits, limit)
        names = [name for name in known if name.endswith(f".{figure}")]
        if asked != FREE and not names:
            raise MistakeError(f"limits.{limit}: no part of the scenario has the figure {figure}")
        for name in names if asked != FREE else ():
            yield Bound(name, side, own(name, side) if asked == OWN else float(asked))
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
    found = {f"{part}.{name}": value for part, name, _, value in measure(motion)}
    if missing := [name for name in names if not math.isfinite(found[name].value)]:
        raise ModelError(f"{', '.join(missing)}: no value in the cycle")
    return {name: found[name] for name in names}


def bound_lines(
    bounds: Sequence[Bound], found: Mapping[str, Found], slopes: Mapping[str, Vector], place: Vector,
    at: str, angle: Callable[[int | None], float],
) -> Iterator[Line]:  # fmt: skip
    """The bounds as linear functions around a place."""
    for name, side, size in bounds:
        one = found[name]
        yield Line(f"{name} {at}", one.value, slopes[name], place, size, side, angle(one.row))
