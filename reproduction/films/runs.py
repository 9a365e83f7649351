"""What the judgement of the film formulas computes, each when first asked for."""

from collections.abc import Callable, Iterator
from functools import cache, cached_property, partial

import numpy as np

from models.contact.analysis.line.history import FilmHistory, film_history
from models.core.quantities import Vector

from ..kushwaha2000.runs import Runs as ValveTrain
from .cam import NODES, CamCycle, Flags, select_trajectory, solve_cycle
from .formulas import CENTRAL, MINIMUM
from .samples import PowerLaw, Sample, draw_sample, fit_law

# Camshaft angles at which the film is solved for: formulas and film turn over some degrees at the reversals.
STEP_DEG = 1.0
# Camshaft speeds (r/min).
SPEEDS = (500.0, 1000.0, 2000.0, 3000.0)
# The one whose pressures and films across the contact are drawn.
SHOWN_RPM = 1000.0
# 2^8 and 2^7 contacts; any other seeds serve.
FIT, VALIDATION = (8, 20001), (7, 20002)


class Runs:
    """`step_deg`, `fit` and `validation` (exponent, seed), `speeds` and `nodes` are for shorter runs."""

    def __init__(
        self,
        step_deg: float = STEP_DEG,
        fit: tuple[int, int] = FIT,
        validation: tuple[int, int] = VALIDATION,
        speeds: tuple[float, ...] = SPEEDS,
        nodes: int = NODES,
    ) -> None:
        self.step_deg, self.speeds, self.nodes = step_deg, speeds, nodes
        self._fit, self._validation = fit, validation
        self.train = ValveTrain()
        self.cycle = cache(self._cycle)

    def solve(self) -> Iterator[float]:
        """Compute everything; yields the share that is done."""
        steps: list[Callable[[], object]] = [partial(self.cycle, speed) for speed in self.speeds]
        steps += [lambda: self.coarser, lambda: self.fit, lambda: self.validation]
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
    def fit(self) -> Sample:
        """Contacts that the power laws are fitted to."""
        return draw_sample(*self._fit)

    @cached_property
    def validation(self) -> Sample:
        """Contacts that they are judged by."""
        return draw_sample(*self._validation)

    @cached_property
    def laws(self) -> dict[tuple[str, bool], PowerLaw]:
        """New laws by film, alone and (True) joined with Martin's film."""
        kinds = [(film, blended) for film in (CENTRAL, MINIMUM) for blended in (False, True)]
        return {kind: fit_law(kind[0], self.fit, kind[1]) for kind in kinds}
