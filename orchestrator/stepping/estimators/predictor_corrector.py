"""Predictor against corrector: what an iterated step's first sweep arrived at, and its last."""

from __future__ import annotations

import numpy as np

from ...engine.exchange import Exchange
from ...masters import Master
from .nodes import effective_degree, extrapolated, interpolated
from .protocol import Attempt
from .step_doubling import StepDoubling


class PredictorCorrector:
    """Milne's device for a coupled step; costs nothing beyond the iterated step itself.

    The first sweep used extrapolated signals, the last one interpolated ones. Both errors are the same
    derivative times the integral of their node polynomials, I_p and I_c, so the corrector's error is
    (predictor - corrector) I_c / (I_p - I_c): a 30th of the difference for Hermite signals and equal steps.
    Outputs with feedthrough were made consistent with their inputs before they are compared. Next to
    the start or an event signals go without rates, or through fewer points: step doubling.
    """

    def check(self, master: Master) -> None:
        if not master.implicit:
            raise ValueError(
                "estimator = 'predictor_corrector': needs a master that corrects; use iterated, or the "
                "estimator schierz or step_doubling"
            )

    def attempt(self, exchange: Exchange, master: Master, time: float, length: float) -> Attempt:
        history = exchange.history
        if history.lacks(exchange.degree) or (exchange.degree == 3 and not history.end_smooth.all()):
            exchange.predicted = None
            return StepDoubling().attempt(exchange, master, time, length)
        degree = effective_degree(exchange)
        predictor = extrapolated(exchange.history, degree).integral(0.0, length)
        corrector = interpolated(exchange.history, degree, length).integral(0.0, length)
        exchange.predicted = np.full(len(exchange.values), np.nan)
        iterations = master.step(exchange, time, length)
        # What was not iterated has no error of its own.
        difference = np.nan_to_num(exchange.predicted - exchange.values, nan=0.0)
        share = corrector / (predictor - corrector)
        return Attempt(iterations, difference * share, degree + 2.0)
