"""What the judgement of the film formulas computes, each when first asked for."""

from collections.abc import Callable, Iterator
from functools import cache, cached_property, partial

import numpy as np

from models.contact.analysis.line.history import FilmHistory, film_history
from models.core.quantities import Vector

from ..kushwaha2000.runs import Runs as ValveTrain
from .cam import NODES, CamCycle, Flags, select_trajectory, solve_cycle
from .samples import Sample, draw_sample

# Camshaft angles at which the film is solved for: formulas and film turn over some degrees at the reversals.
STEP_DEG = 1.0
# Camshaft speeds (r/min).
SPEEDS = (500.0, 1000.0, 2000.0, 3000.0)
# The one whose pressures and films across the contact are drawn.
SHOWN_RPM = 1000.0
# 2^8 contacts; any other seed serves.
SAMPLE = (8, 20001)


class Runs:
    """`step_deg`, `sample` (exponent, seed), `speeds` and `nodes` are for shorter runs."""

    def __init__(
        self,
        step_deg: float = STEP_DEG,
        sample: tuple[int, int] = SAMPLE,
        speeds: tuple[float, ...] = SPEEDS,
        nodes: int = NODES,
    ) -> None:
        self.step_deg, self.speeds, self.nodes = step_deg, speeds, nodes
        self._sample = sample
        self.train = ValveTrain()
        self.cycle = cache(self._cycle)

    def solve(self) -> Iterator[float]:
        """Compute everything; yields the share that is done."""
        steps: list[Callable[[], object]] = [partial(self.cycle, speed) for speed in self.speeds]
        steps += [lambda: self.coarser, lambda: self.sample]
        for n, step in enumerate(steps):
            step()
            yield (n + 1) / len(steps)

    def _cycle(self, speed_rpm: float) -> CamCycle:
        """The cam cycle at a speed."""
        return solve_cycle(self.train, speed_rpm, self.step_deg, self.nodes)

    @property
    def cycles(self) -> list[CamCycle]:
        """The cam cycle at each speed."""
        return [self.cycle(speed) for speed in self.speeds]

    @cached_property
    def coarser(self) -> FilmHistory:
        """The transient film of `shown` with about half as many nodes."""
        turn = self.train.surge(self.shown.speed_rpm)
        return film_history(*select_trajectory(turn), nodes=self.nodes // 4 * 2 + 1)

    @property
    def shown(self) -> CamCycle:
        """The cycle whose field is drawn: that of SHOWN_RPM, or else the first."""
        return next((c for c in self.cycles if c.speed_rpm == SHOWN_RPM), self.cycles[0])

    def ratios(self, name: str) -> Vector:
        """A judged film over the transient one, where there is one, at all angles and speeds."""
        return np.concatenate([c.ratio(name) for c in self.cycles])

    def over_steady(self, name: str) -> Vector:
        """A judged film over the steady one."""
        return np.concatenate([c.over_steady(name) for c in self.cycles])

    def valid(self, name: str) -> Flags:
        """Where its conditions hold."""
        return np.concatenate([c.judged[name].valid for c in self.cycles])

    @cached_property
    def sample(self) -> Sample:
        """Contacts over Table 3."""
        return draw_sample(*self._sample)
