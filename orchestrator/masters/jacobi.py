"""Jacobi: all participants advance in parallel, with inputs extrapolated from the past."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from ..engine.coupling import Coupling
from ..engine.signals import degree_of, extrapolate
from ..engine.sweeps import jacobi_sweep
from .protocol import MasterStep
from .restart import repeat_first_step


@dataclass(frozen=True)
class Jacobi:
    """`extrapolation` of every input over the step: hold, linear, quadratic or hermite."""

    implicit: ClassVar[bool] = False

    extrapolation: str = "linear"

    def __post_init__(self) -> None:
        degree_of(self.extrapolation)

    @cached_property
    def degree(self) -> int:
        """Degree of the input signals."""
        return degree_of(self.extrapolation)

    def step(self, coupling: Coupling, time: float, step: float) -> MasterStep:
        every, history, degree = coupling.wiring.all, coupling.state.history, coupling.wiring.degree
        if history.lacks(degree):
            return repeat_first_step(coupling, sweep_parallel, every, time, step)
        extrapolate(history, degree, coupling.signals)
        sweep_parallel(coupling, every, time, step)
        return MasterStep()


def sweep_parallel(coupling: Coupling, order: tuple[int, ...], time: float, step: float) -> None:
    """Advance all in `order` with the signals as they are, then read them."""
    coupling.sweep(jacobi_sweep, order)(time, step)
