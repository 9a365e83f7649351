"""Estimators of a macro step's local error. To add one, write a function and list it in ESTIMATORS.

The estimator makes the step, because most compute it more than once.

The error of a polynomial through a function's values (and rates) is, to leading order, its node polynomial
times a derivative of that function. What a step's end values are wrong by follows from the integral of it
over the step, and directly from its end value where an output depends on an input at the same instant.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.signals import STEPWISE, History
from ..masters import Master


@dataclass(frozen=True)
class Attempt:
    """A step that was made: sweeps it took, estimated error of every source, P of error ~ H^P, and the equal
    `parts` in which participants made it."""

    iterations: int
    error: Vector
    exponent: float
    parts: int = 1


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


def double_step(coupling: Coupling, master: Master, time: float, length: float) -> Attempt:
    """Error of the halves from their difference to the whole; the halves are kept. Any master.

    Error = (halves - whole) / (1 - p), with p the error of the whole over that of the halves: 2^(k+1) where
    signals of degree k are interpolated. Where they are extrapolated p follows from the points that they go
    through, 2, 14/5, 32/9 for k = 0, 1, 2 and equal steps (Schierz, Arnold, Clauss 2012), and another
    value for outputs that depend on an input at the same instant, which 2^(k+1) gets wrong. Towards the end
    of a step where a source bends polynomials have no order: p is 2, and the difference itself the error.
    """
    half = 0.5 * length
    degree = effective_degree(coupling)
    restarting = coupling.state.history.lacks(coupling.wiring.degree)
    with coupling.points.keep() as start:
        shares = None if master.implicit or restarting else ratios(coupling, degree, half)
        iterations = master.step(coupling, time, length).iterations
        whole = coupling.state.values.copy()
        coupling.points.restore(start)
    with coupling.state.history.passing():
        iterations = max(iterations, master.step(coupling, time, half).iterations)
    coupling.accept(time + half)
    iterations = max(iterations, master.step(coupling, time + half, length - half).iterations)
    if shares is None:
        # The first step after a restart of a signal of degree 1 or 2 interpolates linearly.
        known = degree if master.implicit or degree in (0, 3) else 1
        shares, order = np.full(len(whole), 2.0 ** (known + 1)), known + 2.0
    else:
        order = exponent(coupling, degree)
    if not coupling.state.history.end_smooth.all():
        shares = np.where(coupling.state.history.end_smooth, shares, 2.0)
        order = 2.0
    return Attempt(iterations, (coupling.state.values - whole) / (1.0 - shares), order, parts=2)


def ratios(coupling: Coupling, degree: int, half: float) -> Vector:
    """Error of one extrapolation over two halves, over that of one for each half; for every source."""
    later = coupling.state.history.copy()
    whole = extrapolation_nodes(later, degree)
    later.append(later.times[0] + half, later.values[0], later.rates[0])
    second = extrapolation_nodes(later, degree)
    integrated = whole.integral(0.0, 2.0 * half) / (whole.integral(0.0, half) + second.integral(0.0, half))
    direct = whole(2.0 * half) / second(half)
    return np.where(coupling.wiring.passed_through, direct, integrated)


def exponent(coupling: Coupling, degree: int) -> float:
    """P of error ~ H^P for explicit masters: one less with feedthrough."""
    return degree + (1.0 if coupling.wiring.passed_through.any() else 2.0)


def correct_prediction(coupling: Coupling, master: Master, time: float, length: float) -> Attempt:
    """Milne's device for a coupled step; costs nothing beyond the iterated step itself.

    The first sweep used extrapolated signals, the last one interpolated ones. Both errors are the same
    derivative times the integral of their node polynomials, I_p and I_c, so the corrector's error is
    (predictor - corrector) I_c / (I_p - I_c): a 30th of the difference for Hermite signals and equal steps.
    Outputs with feedthrough were made consistent with their inputs before they are compared. Next to
    the start or an event signals go without rates, or through fewer points: step doubling.
    """
    history, highest = coupling.state.history, coupling.wiring.degree
    if history.lacks(highest) or (highest == 3 and not history.end_smooth.all()):
        return double_step(coupling, master, time, length)
    degree = effective_degree(coupling)
    predictor = extrapolation_nodes(history, degree).integral(0.0, length)
    corrector = interpolation_nodes(history, degree, length).integral(0.0, length)
    made = master.step(coupling, time, length)
    assert made.predicted is not None  # the master is implicit
    # Of what was not iterated the two are equal.
    difference = made.predicted - coupling.state.values
    share = corrector / (predictor - corrector)
    return Attempt(made.iterations, difference * share, degree + 2.0)


# By name: each makes the step from a time, inside `coupling.points.keep()` there, and does not accept its end
# into the history; values, rates and signals of the coupling are then those at the end.
ESTIMATORS: dict[str, Callable[[Coupling, Master, float, float], Attempt]] = {
    "step_doubling": double_step,
    "predictor_corrector": correct_prediction,
}
