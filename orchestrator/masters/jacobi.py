"""Jacobi: all participants advance in parallel, with inputs extrapolated from the past."""

from dataclasses import dataclass
from typing import ClassVar

from ..engine.coupling import Coupling
from ..engine.signals import extrapolate
from ..engine.sweeps import JACOBI
from .protocol import MasterStep, SignalOptions
from .restart import repeat_first_step


@dataclass(frozen=True)
class Jacobi(SignalOptions):
    """`extrapolation` of every input over the step: hold, linear, quadratic or hermite."""

    implicit: ClassVar[bool] = False

    def step(self, coupling: Coupling, time: float, step: float) -> MasterStep:
        every, history, degree = coupling.wiring.all, coupling.state.history, coupling.wiring.degree
        if history.lacks(degree):
            return repeat_first_step(coupling, JACOBI, every, time, step)
        extrapolate(history, degree, coupling.signals)
        coupling.sweep(JACOBI, every, time, step)
        return MasterStep()
