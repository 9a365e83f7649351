"""Jacobi: all participants advance in parallel, with inputs extrapolated from the past."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from ..engine.exchange import Exchange
from ..engine.signals import degree_of, extrapolate
from ..engine.sweeps import jacobi_sweep
from .restart import repeated


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

    def step(self, exchange: Exchange, time: float, step: float) -> int:
        if exchange.history.lacks(exchange.degree):
            return repeated(exchange, parallel, exchange.listed, time, step)
        extrapolate(exchange.history, exchange.degree, exchange.signals)
        parallel(exchange, exchange.listed, time, step)
        return 1


def parallel(exchange: Exchange, order: Sequence[int], time: float, step: float) -> None:
    """Advance all in `order` with the signals as they are, then read them."""
    exchange.make(jacobi_sweep, order)(time, step)
