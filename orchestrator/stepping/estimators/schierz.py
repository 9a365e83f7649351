"""The modified estimate of Schierz, Arnold and Clauss 2012 (doi 10.3384/ecp12076205), section 4."""

from __future__ import annotations

from ...engine.exchange import Exchange
from ...engine.signals import move_origin
from ...masters import Master
from ...masters.jacobi import parallel
from .jacobi_only import refuse_interpolation
from .nodes import effective_degree
from .protocol import Attempt
from .step_doubling import StepDoubling, exponent, ratios


class Schierz:
    """Two halves of a step; the second one also with the first one's signals going on.

    Needs no way back over the whole step, only over its second half. Error = (fresh - continued) / (1 - p),
    see `step_doubling`. For Jacobi masters, where every signal is extrapolated: one that interpolates some
    has errors that this does not see.
    """

    def check(self, master: Master) -> None:
        refuse_interpolation("schierz", "all signals", master)

    def attempt(self, exchange: Exchange, master: Master, time: float, length: float) -> Attempt:
        if exchange.history.lacks(exchange.degree):
            return StepDoubling().attempt(exchange, master, time, length)
        half = 0.5 * length
        middle_time = time + half
        degree = effective_degree(exchange)
        shares = ratios(exchange, degree, half)
        with exchange.history.passing():
            iterations = master.step(exchange, time, half)
        move_origin(exchange.signals, half, exchange.signals)
        exchange.accept(middle_time)
        with exchange.point() as middle:
            parallel(exchange, exchange.listed, middle_time, length - half)
            continued = exchange.values.copy()
            exchange.restore(middle)
            iterations = max(iterations, master.step(exchange, middle_time, length - half))
        return Attempt(iterations, (exchange.values - continued) / (1.0 - shares), exponent(exchange, degree))
