"""What a survey finds: of each method, and of the scenario."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from models.core.system import Port, System

from ..masters import Master, name_of
from ..scenario import Scenario
from .behaviour import At
from .partition import Partition
from .points import Point
from .trajectory import Along


@dataclass
class Surveyed:
    """A method: what was found about it. Steps in s; errors as in the scenario's tolerance."""

    master: Master
    seen: list[At] = field(default_factory=list)
    limit: float = math.inf
    hardest: float = 0.0
    culprit: Port | None = None
    errors: dict[float, dict[str, float]] = field(default_factory=dict)
    within: float = 0.0
    recommended: float = 0.0
    cost: float = math.inf

    @property
    def name(self) -> str:
        return f"{name_of(self.master)} {self.master.extrapolation}"

    @property
    def order(self) -> tuple[str, ...]:
        """The order of participants; empty where it makes no difference."""
        return getattr(self.master, "order", ())

    @property
    def contracting(self) -> float:
        """The largest step seen up to which a plain iteration contracts; NaN for explicit masters."""
        if not self.master.implicit:
            return math.nan
        good = 0.0
        for at in self.seen:
            if not at.contraction < 1.0:
                break
            good = at.step
        return good


@dataclass(frozen=True)
class Survey:
    """A scenario's methods, cheapest first; `own` is the scenario's, `best` the recommended one, if any.

    Errors are those along the course up to `until`, about the instant `typical` (s). `participants` are
    those that were linearised as such, the others are components; `left_out` says why instants were.
    """

    scenario: Scenario
    system: System
    partition: Partition
    points: list[Point]
    methods: list[Surveyed]
    own: Surveyed
    best: Surveyed | None
    until: float
    typical: float
    participants: Mapping[str, Along]
    left_out: list[str]

    @property
    def kinks(self) -> list[str]:
        """Variables that had a kink at a point."""
        return list(dict.fromkeys(kink for point in self.points for kink in point.kinks))
