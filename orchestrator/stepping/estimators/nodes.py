"""Errors of polynomial signals from the places of their nodes.

The error of a polynomial through a function's values (and rates) is, to leading order, its node polynomial
times a derivative of that function. What a step's end values are wrong by follows from the integral of it
over the step, and directly from its end value where an output depends on an input at the same instant.
"""

from __future__ import annotations

from collections.abc import Sequence

from numpy.polynomial import Polynomial

from ...exchange import Exchange
from ...signals import History

IDENTITY = Polynomial([0.0, 1.0])


def node_polynomial(degree: int, nodes: Sequence[float]) -> Polynomial:
    """Product of (s - node) over the nodes of a signal of `degree`; both nodes of a Hermite signal twice."""
    product = Polynomial([1.0])
    for node in nodes[:2] if degree == 3 else nodes[: degree + 1]:
        product = product * (IDENTITY - node) ** (2 if degree == 3 else 1)
    return product


def past(history: History) -> list[float]:
    """The known points' times relative to the newest."""
    return [float(t - history.times[0]) for t in history.times[: history.count]]


def extrapolated(history: History, degree: int) -> Polynomial:
    """Node polynomial, in time after the newest point, of the extrapolated signal."""
    return node_polynomial(degree, past(history))


def interpolated(history: History, degree: int, length: float) -> Polynomial:
    """As `extrapolated`, of the signal through a value (and rate) at the end of the step."""
    return node_polynomial(degree, [length, *past(history)])


def integral(polynomial: Polynomial, start: float, end: float) -> float:
    """Integral from start to end."""
    whole = polynomial.integ()
    return float(whole(end) - whole(start))


def effective_degree(exchange: Exchange) -> int:
    """Degree of the signals that limit the order: quadratic where a Hermite signal lacks rates."""
    if exchange.degree == 3 and not exchange.rated[exchange.connected].all():
        return 2
    return exchange.degree
