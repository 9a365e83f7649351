"""What the judgement of the film formulas computes, each when first asked for."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial

import numpy as np
from scipy.stats import qmc

from models.contact.analysis.line.history import FilmHistory, film_history
from models.contact.analysis.line.line_contact import LineContact
from models.contact.analysis.line.steady import SteadyFilm
from models.contact.ehl_contact import TABLE_3
from models.contact.fluid import Lubricant
from models.contact.hertz import elastic_compliance
from models.core.quantities import Vector

from ..kushwaha2000.runs import Runs as ValveTrain
from .cam import NODES, CamCycle, Flags, select_trajectory, solve_cycle
from .formulas import Formula
from .numerical import list_heights, solve_films

# Steel on steel; by similarity the other dimensions do not count.
COMPLIANCE = elastic_compliance(207e9, 0.3, 207e9, 0.3)
RADIUS, LENGTH, VISCOSITY = 0.02, 0.012, 0.036
# Constant of the squeeze term of (10).
SQUEEZE = 96.775


@dataclass(frozen=True)
class Sample:
    """Scrambled Sobol' points in the logarithms of G, W, U (Kushwaha's, with E = pi/compliance) and in w_s.

    Films (m) of the steady contact and of the one whose bodies close at w_s times the entraining velocity.
    """

    contacts: Sequence[LineContact]
    squeeze: Vector
    steady: Sequence[SteadyFilm | None]
    squeezed: Sequence[SteadyFilm | None]

    @property
    def M(self) -> Vector:
        return np.array([contact.M for contact in self.contacts])

    @property
    def L(self) -> Vector:
        return np.array([contact.L for contact in self.contacts])

    def over_numerical(self, formula: Formula) -> Vector:
        """A formula over the steady numerical film, at every contact."""
        film = np.array([formula.of(contact) for contact in self.contacts])
        return film / list_heights(self.steady, f"{formula.film}_film")

    def squeezed_over_numerical(self, formula: Formula) -> Vector:
        """Kushwaha's film with its squeeze term over the numerical film of the closing bodies."""
        film = np.array([formula.of(contact) for contact in self.contacts])
        return film * np.exp(-SQUEEZE * self.squeeze) / list_heights(self.squeezed, f"{formula.film}_film")


def draw_sample(exponent: int, seed: int) -> Sample:
    """2^exponent contacts."""
    unit = qmc.Sobol(4, scramble=True, rng=seed).random_base2(exponent)
    logs = [np.log(TABLE_3[name]) for name in ("material", "load", "speed")]
    G, W, U = (np.exp(low + unit[:, k] * (high - low)) for k, (low, high) in enumerate(logs))
    squeeze = TABLE_3["squeeze"][0] + unit[:, 3] * (TABLE_3["squeeze"][1] - TABLE_3["squeeze"][0])
    modulus = math.pi / COMPLIANCE
    contacts = [
        LineContact(
            w * modulus * RADIUS * LENGTH, u * modulus * RADIUS / VISCOSITY, RADIUS, LENGTH, COMPLIANCE,
            Lubricant(VISCOSITY, g / modulus),
        )
        for g, w, u in zip(G, W, U, strict=True)
    ]  # fmt: skip
    closing = [replace(c, squeeze=s * c.velocity) for c, s in zip(contacts, squeeze, strict=True)]
    return Sample(contacts, squeeze, solve_films(contacts), solve_films(closing))


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
