"""What step control needs of an estimator."""

from dataclasses import dataclass
from typing import Protocol

from models.core.quantities import Vector

from ...engine.coupling import Coupling
from ...masters import Jacobi, Master, find_name


@dataclass(frozen=True)
class Attempt:
    """A step that was made: sweeps it took, estimated error of every source, P of error ~ H^P, and the equal
    `parts` in which participants made it."""

    iterations: int
    error: Vector
    exponent: float
    parts: int = 1


class Estimator(Protocol):
    """Makes steps and estimates their local error."""

    def check(self, master: Master) -> None:
        """ValueError, with the remedy, if this estimator cannot judge that master."""
        ...

    def attempt(self, coupling: Coupling, master: Master, time: float, length: float) -> Attempt:
        """The step from `time`; values, rates and signals of the coupling are then those at its end.

        Called inside `coupling.points.keep()` at `time`. Does not accept the end into the history.
        """
        ...


def refuse_interpolation(estimator: str, compared: str, master: Master) -> None:
    """ValueError, with the remedy, unless the master extrapolates every signal."""
    if not isinstance(master, Jacobi):
        better = "predictor_corrector or step_doubling" if master.implicit else "step_doubling"
        raise ValueError(
            f"estimator = {estimator!r}: compares extrapolations of {compared}, as the master jacobi makes "
            f"them; {find_name(master)} interpolates some: use {better}"
        )
