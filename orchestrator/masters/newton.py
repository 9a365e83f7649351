"""Newton: the end values of a macro step by Newton's method, with sensitivities measured by rollback."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from models.core.quantities import Vector

from ..engine.exchange import Exchange
from ..engine.signals import degree_of
from .acceleration import Carried
from .interface import interface_of
from .iteration import check_limits, converge
from .jacobi import parallel
from .parts import step_in_parts

# Perturbation of an end value, in nominal sizes: far above what participants integrate to (1e-10), and far
# below where they bend.
PERTURBATION = 1e-5
# The Jacobian serves for steps within this factor of the one it was measured in,
SERVES_WITHIN = 1.5
# and as long as it converges in that many iterations.
SLOW = 6


@dataclass(frozen=True)
class Newton:
    """As `iterated`, with the interface's Jacobian: for couplings where fixed points diverge or creep.

    The Jacobian is measured once (each participant advances once for every value, and rate, that it is
    given) and serves for many macro steps. Jacobi sweeps; other options as those of `iterated`.
    """

    implicit: ClassVar[bool] = True

    extrapolation: str = "linear"
    tolerance: float = 1e-9
    maximum_iterations: int = 30
    iterate: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        degree_of(self.extrapolation)
        check_limits(self.tolerance, self.maximum_iterations)

    @cached_property
    def degree(self) -> int:
        """Degree of the input signals."""
        return degree_of(self.extrapolation)

    def step(self, exchange: Exchange, time: float, step: float) -> int:
        def iterate(part: list[int]) -> int:
            key = f"jacobian {part[0]}"
            held = exchange.carried.get(key)
            if held is None or not 1.0 / SERVES_WITHIN < step / held["step"] < SERVES_WITHIN:
                held = {"step": step, "matrix": measured(exchange, part, time, step)}
            iterations = converge(
                exchange, part, time, step, parallel, parallel,
                lambda carried, step: Correction(held["matrix"]), self.tolerance, self.maximum_iterations,
            )  # fmt: skip
            exchange.carried[key] = held if iterations <= SLOW else None
            return iterations

        return step_in_parts(exchange, (), self.iterate, time, step, iterate)


class Correction:
    """Newton's correction of a guess v for v = G(v): v + (1 - J)^-1 (G(v) - v)."""

    def __init__(self, jacobian: Vector) -> None:
        self._jacobian = jacobian

    def next(self, guess: Vector, result: Vector) -> Vector:
        matrix = np.eye(len(self._jacobian)) - self._jacobian
        return np.asarray(guess + np.linalg.lstsq(matrix, result - guess, rcond=1e-12)[0])

    def carried(self) -> Carried:
        return {}


def measured(exchange: Exchange, part: Sequence[int], time: float, step: float) -> Vector:
    """d(end values after a Jacobi sweep) / d(end values that its signals assume), in the interface's units.

    The participants end where they were, and the signals are the extrapolation, as before.
    """
    interface = interface_of(exchange, part, step)
    end = time + step
    values, rates, signals = exchange.values.copy(), exchange.rates.copy(), exchange.signals.copy()
    guess = interface.predicted(step)
    with exchange.rollback(part) as roll_back:
        interface.assume(guess, end)
        parallel(exchange, part, time, step)
        result = interface.vector()
        found_values, found_rates = exchange.values.copy(), exchange.rates.copy()
        matrix = np.zeros((len(guess), len(guess)))
        for j in range(len(guess)):
            source = interface.source(j)
            fed = [i for i in part if source in exchange.columns[i]]
            roll_back()
            perturbed = guess.copy()
            perturbed[j] += PERTURBATION
            interface.assume(perturbed, end)
            parallel(exchange, fed, time, step)
            matrix[:, j] = (interface.vector() - result) / PERTURBATION
            exchange.values[:], exchange.rates[:] = found_values, found_rates
        roll_back()
    exchange.values[:], exchange.rates[:], exchange.signals[:] = values, rates, signals
    return matrix
