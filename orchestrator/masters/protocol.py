"""What the run needs of a master."""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, NamedTuple, Protocol

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.signals import find_degree


class MasterStep(NamedTuple):
    """What a master did in a macro step.

    `iterations`: sweeps over the participants that were iterated most; 1 of an explicit step. `predicted`:
    the values of all sources after the first sweep; None of an explicit step.
    """

    iterations: int = 1
    predicted: Vector | None = None


@dataclass(frozen=True)
class SignalOptions:
    """The option that all masters have: `extrapolation` names the input signals over a step.

    `order`, `iterate` and `acceleration` are options of some.
    """

    extrapolation: str = "linear"

    def __post_init__(self) -> None:
        find_degree(self.extrapolation)

    @cached_property
    def degree(self) -> int:
        """Degree of the input signals."""
        return find_degree(self.extrapolation)

    @property
    def order(self) -> tuple[str, ...]:
        return ()

    @property
    def iterate(self) -> tuple[str, ...]:
        return ()

    @property
    def acceleration(self) -> str:
        return ""


class Master(Protocol):
    """Advances all participants by one macro step.

    `implicit`: end values are consistent with the inputs that led to them (a converged iteration).
    """

    implicit: ClassVar[bool]

    @property
    def extrapolation(self) -> str:
        """The name of the input signals, as a scenario has it."""
        ...

    @property
    def degree(self) -> int:
        """Degree of the input signals: 0 held, 1 linear, 2 quadratic, 3 Hermite."""
        ...

    @property
    def order(self) -> tuple[str, ...]:
        """The order of participants; empty: that of the scenario, or it makes no difference."""
        ...

    @property
    def iterate(self) -> tuple[str, ...]:
        """The participants that are iterated together; empty: every loop of connections, or none."""
        ...

    @property
    def acceleration(self) -> str:
        """How the iteration is accelerated; empty: by nothing that could be chosen."""
        ...

    def step(self, coupling: Coupling, time: float, step: float) -> MasterStep:
        """From `time` to `time + step`."""
        ...
