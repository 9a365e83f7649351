"""What the judgement of the film formulas computes, each when first asked for."""

from __future__ import annotations

from functools import cached_property

from ..kushwaha2000.runs import SPEEDS
from ..kushwaha2000.runs import Runs as ValveTrain
from .cam import CamCycle, cam_cycle
from .formulas import CENTRAL, MINIMUM
from .samples import PowerLaw, Sample, fitted, sample

# Camshaft angles at which the film is solved for: formulas and film turn over some degrees at the reversals.
STEP_DEG = 2.0
# 2^8 and 2^7 contacts; any other seeds serve.
FIT, VALIDATION = (8, 20001), (7, 20002)


class Runs:
    """`step_deg`, `fit` and `validation` (exponent, seed) are for shorter runs."""

    def __init__(
        self,
        step_deg: float = STEP_DEG,
        fit: tuple[int, int] = FIT,
        validation: tuple[int, int] = VALIDATION,
        speeds: tuple[float, ...] = SPEEDS,
    ) -> None:
        self.step_deg, self.speeds = step_deg, speeds
        self._fit, self._validation = fit, validation

    @cached_property
    def cycles(self) -> list[CamCycle]:
        """The cam cycle at each speed."""
        train = ValveTrain()
        return [cam_cycle(train, speed, self.step_deg) for speed in self.speeds]

    @cached_property
    def fit(self) -> Sample:
        """Contacts that the power laws are fitted to."""
        return sample(*self._fit)

    @cached_property
    def validation(self) -> Sample:
        """Contacts that they are judged by."""
        return sample(*self._validation)

    @cached_property
    def laws(self) -> dict[tuple[str, bool], PowerLaw]:
        """New laws by film, alone and (True) joined with Martin's film."""
        kinds = [(film, blended) for film in (CENTRAL, MINIMUM) for blended in (False, True)]
        return {kind: fitted(kind[0], self.fit, kind[1]) for kind in kinds}
