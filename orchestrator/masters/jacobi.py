"""Jacobi: all participants advance in parallel, with inputs extrapolated from the past."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from ..exchange import Exchange
from ..signals import degree_of, extrapolate


@dataclass(frozen=True)
class Jacobi:
    """`extrapolation` of every input over the step: hold, linear or quadratic."""

    implicit: ClassVar[bool] = False

    extrapolation: str = "linear"

    def __post_init__(self) -> None:
        degree_of(self.extrapolation)

    @cached_property
    def degree(self) -> int:
        """Degree of the input signals."""
        return degree_of(self.extrapolation)

    def step(self, exchange: Exchange, time: float, step: float) -> int:
        extrapolate(exchange.history, self.degree, exchange.signals)
        for i, participant in enumerate(exchange.participants):
            exchange.write(i)
            participant.advance(time, step)
        for i in range(len(exchange.participants)):
            exchange.read(i)
        return 1
