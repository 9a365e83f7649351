"""Gauss-Seidel: participants advance one after the other, each using what the earlier ones arrived at."""

from dataclasses import dataclass
from typing import ClassVar

from ..engine.coupling import Coupling
from ..engine.signals import extrapolate
from ..engine.sweeps import GAUSS_SEIDEL
from .protocol import MasterStep, SignalOptions
from .restart import repeat_first_step


@dataclass(frozen=True)
class GaussSeidel(SignalOptions):
    """Inputs from participants that already advanced are interpolated over the step, others extrapolated.

    `order` names all participants; empty: the order in which the scenario lists them.
    """

    implicit: ClassVar[bool] = False

    order: tuple[str, ...] = ()

    def step(self, coupling: Coupling, time: float, step: float) -> MasterStep:
        order, history, degree = (
            resolve_order(coupling, self.order),
            coupling.state.history,
            coupling.wiring.degree,
        )
        if history.lacks(degree):
            return repeat_first_step(coupling, GAUSS_SEIDEL, order, time, step)
        extrapolate(history, degree, coupling.signals)
        coupling.sweep(GAUSS_SEIDEL, order, time, step)
        return MasterStep()


def resolve_order(coupling: Coupling, names: tuple[str, ...]) -> tuple[int, ...]:
    """The participants' numbers in the order to advance; ValueError unless all are named once."""
    return coupling.bind(_find_order, names) if names else coupling.wiring.all


def _find_order(coupling: Coupling, names: tuple[str, ...]) -> tuple[int, ...]:
    known = coupling.wiring.names
    if sorted(names) != sorted(known):
        raise ValueError(f"order = {', '.join(names)}: must name each of {', '.join(known)} once")
    return tuple(known.index(name) for name in names)
