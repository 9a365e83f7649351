"""Gauss-Seidel: participants advance one after the other, each using what the earlier ones arrived at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from ..engine.exchange import Exchange
from ..engine.signals import degree_of, extrapolate
from ..engine.sweeps import gauss_seidel_sweep
from .restart import repeated


@dataclass(frozen=True)
class GaussSeidel:
    """Inputs from participants that already advanced are interpolated over the step, others extrapolated.

    `order` names all participants; empty: the order in which the scenario lists them.
    """

    implicit: ClassVar[bool] = False

    extrapolation: str = "linear"
    order: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        degree_of(self.extrapolation)

    @cached_property
    def degree(self) -> int:
        """Degree of the input signals."""
        return degree_of(self.extrapolation)

    def step(self, exchange: Exchange, time: float, step: float) -> int:
        order = order_of(exchange, self.order)
        if exchange.history.lacks(exchange.degree):
            return repeated(exchange, sweep, order, time, step)
        extrapolate(exchange.history, exchange.degree, exchange.signals)
        sweep(exchange, order, time, step)
        return 1


def order_of(exchange: Exchange, names: tuple[str, ...]) -> list[int]:
    """The participants' numbers in the order to advance; ValueError unless all are named once."""
    if not names:
        return exchange.listed
    if sorted(names) != sorted(exchange.names):
        raise ValueError(f"order = {', '.join(names)}: must name each of {', '.join(exchange.names)} once")
    return [exchange.names.index(name) for name in names]


def sweep(exchange: Exchange, order: Sequence[int], time: float, step: float) -> None:
    """Advance in `order`, replacing each participant's signals by interpolation of its arrival."""
    exchange.make(gauss_seidel_sweep, order)(time, step)
