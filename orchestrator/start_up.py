"""The past that a run does not have: derivatives of the exchanged values at the start.

Polynomial signals need earlier values, and beginning at a lower degree costs the whole run its order.
So the start is probed: two short steps, fit, roll back, and again with the signals found. Every round
makes one more derivative right (hold gives values to O(e), so slopes of feedthrough outputs only in the
second round), to O(e) with probes of length e. With e proportional to the macro step H, the error that
this leaves, H^2 e, is of third order.
"""

from __future__ import annotations

from models.quantities import Vector

from .exchange import Exchange
from .signals import History, extrapolate, move_origin

# Probe length over macro step. Second differences lose (1/100)^-2 of 1e-16: 1e-12 of the values.
PROBE = 0.01

# Slopes and curvatures of a chain of three feedthrough components settle in four rounds.
ROUNDS = 4


def probe_start(exchange: Exchange, time: float, step: float) -> None:
    """Put two points before the start into the exchange's history; participants end as they were.

    Where one cannot be rolled back there is no such past: the first steps are of lower degree.
    """
    degree = len(exchange.signals) - 1
    if degree == 0 or not all(participant.restorable for participant in exchange.participants):
        return
    short = PROBE * step
    start = exchange.values.copy()
    signals = exchange.signals
    for _ in range(ROUNDS):
        found = History(time, start)
        with exchange.rollback() as roll_back:
            for n in range(2):
                extrapolate(exchange.history, degree, signals)
                move_origin(signals, n * short, signals)
                for i, participant in enumerate(exchange.participants):
                    exchange.write(i)
                    participant.advance(time + n * short, short)
                for i in range(len(exchange.participants)):
                    exchange.read(i)
                found.append(time + (n + 1) * short, exchange.values)
            roll_back()
        slope, curvature = _derivatives_at_oldest(found)
        exchange.history = History(time - 2.0 * short, start - 2.0 * short * (slope - short * curvature))
        exchange.history.append(time - short, start - short * (slope - 0.5 * short * curvature))
        exchange.history.append(time, start)
    exchange.values[:] = start


def _derivatives_at_oldest(found: History) -> tuple[Vector, Vector]:
    """First and second derivative of the parabola through three points, at the oldest."""
    (t2, t1, t0), (v2, v1, v0) = found.times, found.values
    d1 = (v1 - v0) / (t1 - t0)
    d2 = ((v2 - v1) / (t2 - t1) - d1) / (t2 - t0)
    return d1 - (t1 - t0) * d2, 2.0 * d2
