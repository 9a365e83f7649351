"""Errors of polynomial signals from the places of their nodes.

The error of a polynomial through a function's values (and rates) is, to leading order, its node polynomial
times a derivative of that function. What a step's end values are wrong by follows from the integral of it
over the step, and directly from its end value where an output depends on an input at the same instant.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ...engine.coupling import Coupling
from ...engine.signals import STEPWISE, History

# Gauss's quadrature with three points is exact up to degree five; node polynomials have four at most.
_GAUSS = ((-math.sqrt(0.6), 5.0 / 9.0), (0.0, 8.0 / 9.0), (math.sqrt(0.6), 5.0 / 9.0))


@dataclass(frozen=True)
class NodePolynomial:
    """Product of (s - node)^power, s in time after the newest known point."""

    nodes: Sequence[float]
    power: int

    def __call__(self, s: float) -> float:
        product = 1.0
        for node in self.nodes:
            product *= (s - node) ** self.power
        return product

    def integral(self, start: float, end: float) -> float:
        """Integral from start to end."""
        middle, half = 0.5 * (start + end), 0.5 * (end - start)
        return half * sum(weight * self(middle + half * x) for x, weight in _GAUSS)


def node_polynomial(degree: int, nodes: Sequence[float]) -> NodePolynomial:
    """That of a signal of `degree` through the first of `nodes`: both of a Hermite signal count twice."""
    return NodePolynomial(nodes[:2], 2) if degree == 3 else NodePolynomial(nodes[: degree + 1], 1)


def past(history: History) -> list[float]:
    """The known points' times relative to the newest."""
    newest = float(history.times[0])
    return [float(t) - newest for t in history.times[: history.count]]


def extrapolation_nodes(history: History, degree: int) -> NodePolynomial:
    """That of the extrapolated signal."""
    return node_polynomial(degree, past(history))


def interpolation_nodes(history: History, degree: int, length: float) -> NodePolynomial:
    """That of the signal through a value (and rate) at the end of the step."""
    return node_polynomial(degree, [length, *past(history)])


def effective_degree(coupling: Coupling) -> int:
    """Degree of the signals that limit the order: of those that participants follow the lowest, linear where
    a participant holds its inputs, quadratic where a Hermite signal lacks rates. Stepwise ones limit none."""
    highest = min(coupling.wiring.degree, 1) if any(coupling.wiring.held) else coupling.wiring.degree
    degrees = coupling.state.history.degrees[coupling.wiring.connected]
    lowest = degrees[degrees != STEPWISE].min(initial=highest)
    if lowest == 3 and not coupling.state.history.rated[coupling.wiring.connected].all():
        return 2
    return int(lowest)
