"""Iterated: the macro step is repeated from its start until the exchanged end values agree."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from models.quantities import Vector

from ..errors import NonConvergenceError, one_of
from ..exchange import Exchange
from ..signals import degree_of, extrapolate, interpolate
from .acceleration import ACCELERATIONS
from .gauss_seidel import order_of, sweep


@dataclass(frozen=True)
class Iterated:
    """Fixed-point iteration with rollback over Gauss-Seidel sweeps.

    Inputs are interpolated over the step between known values and the end values of the last sweep:
    `extrapolation` is the degree of that signal (hold: the end value). Converged when no end value
    changes by more than `tolerance` of its nominal size. `acceleration` is none, aitken or anderson.
    """

    implicit: ClassVar[bool] = True

    extrapolation: str = "linear"
    tolerance: float = 1e-9
    maximum_iterations: int = 30
    acceleration: str = "anderson"
    order: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        degree_of(self.extrapolation)
        if self.acceleration not in ACCELERATIONS:
            raise ValueError(
                f"acceleration = {self.acceleration!r}: {one_of(ACCELERATIONS, self.acceleration)}"
            )
        if not self.tolerance > 0.0:
            raise ValueError(f"tolerance = {self.tolerance:g}: must be > 0")
        if self.maximum_iterations < 1:
            raise ValueError(f"maximum_iterations = {self.maximum_iterations}: must be at least 1")

    @cached_property
    def degree(self) -> int:
        """Degree of the input signals."""
        return degree_of(self.extrapolation)

    def step(self, exchange: Exchange, time: float, step: float) -> int:
        degree = self.degree
        order = order_of(exchange, self.order)
        acceleration = ACCELERATIONS[self.acceleration]()
        guess = _first_guess(exchange, degree, step)
        residuals: list[Vector] = []
        with exchange.rollback() as roll_back:
            for iteration in range(1, self.maximum_iterations + 1):
                if iteration > 1:
                    roll_back()
                interpolate(exchange.history, degree, time + step, guess * exchange.nominal, exchange.signals)
                sweep(exchange, degree, order, time, step)
                result = exchange.values / exchange.nominal
                residuals.append(np.abs(result - guess))
                # Relative to the value where that is larger than nominal: an angle grows without end.
                if np.all(residuals[-1] <= self.tolerance * np.maximum(1.0, np.abs(result))):
                    return iteration
                guess = acceleration.next(guess, result)
        raise NonConvergenceError(self._message(exchange, residuals, time, step))

    def _message(self, exchange: Exchange, residuals: list[Vector], time: float, step: float) -> str:
        worst = int(np.argmax(residuals[-1]))
        trail = [float(r[worst]) for r in residuals]
        contraction = (trail[-1] / trail[0]) ** (1.0 / max(1, len(trail) - 1)) if trail[0] > 0.0 else np.inf
        targets = [str(c.target) for c in exchange.system.connections if c.source == exchange.sources[worst]]
        return (
            f"{exchange.sources[worst]} -> {', '.join(targets)}: no convergence at t = {time:.6g} s in "
            f"{len(trail)} iterations (change {trail[-1]:.2g} of nominal, tolerance {self.tolerance:g}, "
            f"contraction {contraction:.2f} per iteration, macro step {step:g} s); reduce macro_step, "
            "raise maximum_iterations, or use acceleration anderson"
        )


def _first_guess(exchange: Exchange, degree: int, step: float) -> Vector:
    """The extrapolated end values, in nominal units."""
    signals = exchange.signals
    extrapolate(exchange.history, degree, signals)
    powers = np.array([1.0, step, 0.5 * step * step])[: degree + 1]
    return np.asarray(powers @ signals / exchange.nominal)
