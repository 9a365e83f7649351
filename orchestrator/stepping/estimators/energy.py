"""Energy residual: power that the coupling creates at the end of a step (Sadjina et al. 2017)."""

from __future__ import annotations

import numpy as np

from ...bonds import bonds_of
from ...exchange import Exchange
from ...masters import Master
from ...signals import evaluate
from .nodes import effective_degree
from .protocol import Attempt
from .step_doubling import exponent


class EnergyResidual:
    """Residual power of every power bond at the end of the step, times the step, as an error in joules.

    One side works with its own effort and the flow that it assumed, the other with its own flow and the
    effort that it assumed; the difference of the two powers is created by the coupling. The residual energy
    is turned into an error of the effort: over the flow, or its nominal size if that is larger. For masters
    that extrapolate: at the end of a converged iteration both sides agree.
    """

    def check(self, master: Master) -> None:
        if master.implicit:
            raise ValueError(
                "estimator = 'energy': a converged iteration leaves no residual power; use "
                "predictor_corrector or step_doubling"
            )

    def attempt(self, exchange: Exchange, master: Master, time: float, length: float) -> Attempt:
        iterations = master.step(exchange, time, length)
        assumed, rates = np.zeros_like(exchange.values), np.zeros_like(exchange.rates)
        evaluate(exchange.signals, length, assumed, rates)
        error = np.zeros_like(exchange.values)
        for bond in bonds_of(exchange.system):
            effort, flow = exchange.number[bond.effort], exchange.number[bond.flow]
            e, f = exchange.values[effort], exchange.values[flow]
            residual = e * assumed[flow] - assumed[effort] * f
            error[effort] += residual / max(abs(f), exchange.nominal[flow])
        return Attempt(iterations, error, exponent(exchange, effective_degree(exchange)))
