"""What a design wants, and what a search has found."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from models.core.quantities import Vector

from .figures import AREA, Bound, Objective
from .slp import Active

# Of a limit by cycles, that a confirmed lift may exceed it.
CONFIRMED = 5e-3


@dataclass(frozen=True)
class Wanted:
    """What is wanted, and limits in SI units: sizes of the cam's own, of pressures by contact, of gaps by
    spring, the least load at all `speeds` (rad/s), the `kept` ones up to which contact is kept, the highest
    first, the least film ratio of the cam's contact (0: any), figures at `speeds`, the share of area, an
    `idle` speed, at which films and figures are free: no cam has a film there; and speeds at which figures of
    `landings` are limited besides."""

    sizes: Mapping[str, float]
    pressures: Mapping[str, float]
    gaps: Mapping[str, float]
    least_load: float
    speeds: Sequence[float]
    kept: Sequence[float]
    film: float = 0.0
    figures: Sequence[Bound] = ()
    area: float = 0.0
    objective: Objective = Objective()
    idle: Sequence[float] = ()
    landings: Sequence[float] = ()


class Found(NamedTuple):
    """Unknowns with the objective, 1 as of the scenario's cam and better above, the limits that their cycles
    exceed, each with the share, and the area over that of the scenario's cam."""

    unknowns: Vector
    objective: float
    beyond: Mapping[str, float]
    area: float

    @property
    def violation(self) -> float:
        return sum(self.beyond.values())

    @property
    def rank(self) -> float:
        """Those that keep the limits go before others; these by their violation."""
        return self.objective if not self.beyond else -self.violation


class Improved(NamedTuple):
    """The best that cycles confirm, and what holds it: active limits, with the cam angles (rad) where.

    `ended`: that steps became too small, where they did.
    """

    found: Found
    active: Sequence[tuple[Active, float]]
    ended: str = ""


def describe(found: Found, objective: Objective) -> str:
    """In words."""
    text = f"area {100.0 * (found.area - 1.0):+.2f} %"
    if objective.name != AREA:
        change = objective.sign * 100.0 * (found.objective - 1.0)
        text = f"{objective.name.replace('_', ' ')} {change:+.2f} %, {text}"
    beyond = describe_beyond(found.beyond)
    return f"{text}; beyond limits: {beyond}" if beyond else f"{text}, all limits kept"


def describe_beyond(beyond: Mapping[str, float]) -> str:
    """Limits with the shares by which they are exceeded."""
    return ", ".join(f"{name.replace('_', ' ')} by {100.0 * share:.2g} %" for name, share in beyond.items())
