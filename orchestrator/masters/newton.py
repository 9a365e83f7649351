"""Newton: the end values of a macro step by Newton's method, with sensitivities measured by rollback."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from models.quantities import Vector

from ..exchange import Exchange
from ..signals import degree_of, evaluate, extrapolate, interpolate
from .acceleration import Carried
from .gauss_seidel import order_of, sweep
from .iteration import Interface, converge
from .jacobi import parallel
from .parts import parts_of

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
        if not self.tolerance > 0.0:
            raise ValueError(f"tolerance = {self.tolerance:g}: must be > 0")
        if self.maximum_iterations < 1:
            raise ValueError(f"maximum_iterations = {self.maximum_iterations}: must be at least 1")

    @cached_property
    def degree(self) -> int:
        """Degree of the input signals."""
        return degree_of(self.extrapolation)

    def step(self, exchange: Exchange, time: float, step: float) -> int:
        if exchange.parts is None:
            exchange.parts = parts_of(exchange, order_of(exchange, ()), self.iterate)
        extrapolate(exchange.history, self.degree, exchange.signals)
        most = 1
        for part in exchange.parts:
            if len(part) == 1:
                sweep(exchange, part, time, step)
                continue
            key = f"jacobian {part[0]}"
            held = exchange.carried.get(key)
            if held is None or not 1.0 / SERVES_WITHIN < step / held["step"] < SERVES_WITHIN:
                held = {"step": step, "matrix": measured(exchange, part, time, step)}
            matrix = held["matrix"]
            iterations = converge(
                exchange, part, time, step, parallel, parallel, lambda carried, step: Correction(matrix),  # noqa: B023
                self.tolerance, self.maximum_iterations,
            )  # fmt: skip
            exchange.carried[key] = held if iterations <= SLOW else None
            most = max(most, iterations)
        return most


class Correction:
    """Newton's correction of a guess v for v = G(v): v + (1 - J)^-1 (G(v) - v)."""

    def __init__(self, jacobian: Vector) -> None:
        self._matrix = np.eye(len(jacobian)) - jacobian

    def next(self, guess: Vector, result: Vector) -> Vector:
        return np.asarray(guess + np.linalg.lstsq(self._matrix, result - guess, rcond=1e-12)[0])

    def carried(self) -> Carried:
        return {}


def measured(exchange: Exchange, part: Sequence[int], time: float, step: float) -> Vector:
    """d(end values after a Jacobi sweep) / d(end values that its signals assume), in the interface's units.

    The participants end where they were, and the signals are the extrapolation, as before.
    """
    interface = Interface(exchange, part, step)
    h, end = exchange.history, time + step
    values, rates = exchange.values.copy(), exchange.rates.copy()
    before: dict[str, Any] = {"values": values.copy(), "rates": rates.copy()}
    evaluate(exchange.signals, step, values, rates)
    guess = interface.vector(values, rates)
    kept = exchange.signals.copy()

    def assume(vector: Vector) -> None:
        interface.put(vector, values, rates)
        interpolate(h, exchange.degree, end, values, rates, exchange.signals)
        for i in exchange.listed:
            if i not in part:
                exchange.signals[:, exchange.slices[i]] = kept[:, exchange.slices[i]]

    with exchange.rollback(part) as roll_back:
        assume(guess)
        parallel(exchange, part, time, step)
        result = interface.vector(exchange.values, exchange.rates)
        found_values, found_rates = exchange.values.copy(), exchange.rates.copy()
        matrix = np.zeros((len(guess), len(guess)))
        for j in range(len(guess)):
            source = interface.source(j)
            fed = [i for i in part if source in exchange.columns[i]]
            roll_back()
            perturbed = guess.copy()
            perturbed[j] += PERTURBATION
            assume(perturbed)
            parallel(exchange, fed, time, step)
            matrix[:, j] = (interface.vector(exchange.values, exchange.rates) - result) / PERTURBATION
            exchange.values[:], exchange.rates[:] = found_values, found_rates
        roll_back()
    exchange.values[:], exchange.rates[:] = before["values"], before["rates"]
    exchange.signals[:] = kept
    return matrix
