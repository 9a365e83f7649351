"""The past that a run does not have: steps of explicit masters after the start or an event.

Extrapolated signals need earlier values, and beginning at a lower degree would cost the whole run its
order. So the first steps are repeated with signals interpolated to the values that they arrived at. Linear
interpolation over one step, with a local error of its third order, is enough for signals of degree two;
Hermite signals need one such step for their fourth.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..engine.exchange import Exchange
from ..engine.signals import extrapolate, interpolate

# Each sweep makes one more order right, and passes rates one participant further.
SWEEPS = 8
UNCHANGED = 1e-12

Sweep = Callable[[Exchange, Sequence[int], float, float], None]


def repeated(exchange: Exchange, sweep: Sweep, order: Sequence[int], time: float, step: float) -> int:
    """Make the step by `sweep`, each time with signals through the end values found, until these stay.

    At most SWEEPS times: this is no converged iteration. Once, with signals of lower degree, where a
    participant cannot be rolled back. Returns the number of sweeps.
    """
    end = time + step
    extrapolate(exchange.history, exchange.degree, exchange.signals)
    if not exchange.restorable:
        sweep(exchange, order, time, step)
        return 1
    with exchange.rollback(exchange.listed) as roll_back:
        for count in range(1, SWEEPS + 1):
            if count > 1:
                roll_back()
                interpolate(
                    exchange.history, exchange.degree, end, exchange.values, exchange.rates, exchange.signals
                )
            before = exchange.values.copy()
            sweep(exchange, order, time, step)
            change = np.abs(exchange.values - before)
            if np.all(change <= UNCHANGED * (exchange.nominal + np.abs(exchange.values))):
                break
    return count
