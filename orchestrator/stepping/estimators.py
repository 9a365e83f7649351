"""Estimators of a macro step's local error. To add one, write a class and list it in ESTIMATORS.

The estimator makes the step, because most compute it more than once.

The error of a polynomial through a function's values (and rates) is, to leading order, its node polynomial
times a derivative of that function. What a step's end values are wrong by follows from the integral of it
over the step, and directly from its end value where an output depends on an input at the same instant.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.energy.bonds import find_exchanged_bonds
from ..engine.signals import STEPWISE, History, evaluate, move_origin
from ..engine.sweeps import JACOBI
from ..masters import Jacobi, Master, find_name


@dataclass(frozen=True)
class Attempt:
    """A step that was made: sweeps it took, estimated error of every source, P of error ~ H^P, and the equal
    `parts` in which participants made it."""

    iterations: int
    error: Vector
    exponent: float
    parts: int = 1


class Estimator(Protocol):
    """Makes steps and estimates their local error."""

    def check(self, master: Master) -> None:
        """ValueError, with the remedy, if this estimator cannot judge that master."""
        ...

    def attempt(self, coupling: Coupling, master: Master, time: float, length: float) -> Attempt:
        """The step from `time`; values, rates and signals of the coupling are then those at its end.

        Called inside `coupling.points.keep()` at `time`. Does not accept the end into the history.
        """
        ...


def refuse_interpolation(estimator: str, compared: str, master: Master) -> None:
    """ValueError, with the remedy, unless the master extrapolates every signal."""
    if not isinstance(master, Jacobi):
        better = "predictor_corrector or step_doubling" if master.implicit else "step_doubling"
        raise ValueError(
            f"estimator = {estimator!r}: compares extrapolations of {compared}, as the master jacobi makes "
            f"them; {find_name(master)} interpolates some: use {better}"
        )


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


class StepDoubling:
    """Error of the halves from their difference to the whole; the halves are kept. Any master.

    Error = (halves - whole) / (1 - p), with p the error of the whole over that of the halves: 2^(k+1) where
    signals of degree k are interpolated. Where they are extrapolated p follows from the points that they go
    through, 2, 14/5, 32/9 for k = 0, 1, 2 and equal steps (Schierz, Arnold, Clauss 2012), and another
    value for outputs that depend on an input at the same instant, which 2^(k+1) gets wrong. Towards the end
    of a step where a source bends polynomials have no order: p is 2, and the difference itself the error.
    """

    def check(self, master: Master) -> None:
        pass

    def attempt(self, coupling: Coupling, master: Master, time: float, length: float) -> Attempt:
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


class Schierz:
    """Two halves of a step; the second one also with the first one's signals going on.

    Schierz, Arnold and Clauss 2012 (doi 10.3384/ecp12076205), section 4.

    Needs no way back over the whole step, only over its second half. Error = (fresh - continued) / (1 - p),
    see `StepDoubling`. For Jacobi masters, where every signal is extrapolated: one that interpolates some
    has errors that this does not see.
    """

    def check(self, master: Master) -> None:
        refuse_interpolation("schierz", "all signals", master)

    def attempt(self, coupling: Coupling, master: Master, time: float, length: float) -> Attempt:
        if coupling.state.history.lacks(coupling.wiring.degree):
            return StepDoubling().attempt(coupling, master, time, length)
        half = 0.5 * length
        middle_time = time + half
        degree = effective_degree(coupling)
        shares = ratios(coupling, degree, half)
        with coupling.state.history.passing():
            iterations = master.step(coupling, time, half).iterations
        move_origin(coupling.signals, half, coupling.signals)
        coupling.accept(middle_time)
        with coupling.points.keep() as middle:
            coupling.sweep(JACOBI, coupling.wiring.all, middle_time, length - half)
            continued = coupling.state.values.copy()
            coupling.points.restore(middle)
            iterations = max(iterations, master.step(coupling, middle_time, length - half).iterations)
        error = (coupling.state.values - continued) / (1.0 - shares)
        return Attempt(iterations, error, exponent(coupling, degree), parts=2)


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

    def attempt(self, coupling: Coupling, master: Master, time: float, length: float) -> Attempt:
        history, highest = coupling.state.history, coupling.wiring.degree
        if history.lacks(highest) or (highest == 3 and not history.end_smooth.all()):
            return StepDoubling().attempt(coupling, master, time, length)
        degree = effective_degree(coupling)
        predictor = extrapolation_nodes(history, degree).integral(0.0, length)
        corrector = interpolation_nodes(history, degree, length).integral(0.0, length)
        made = master.step(coupling, time, length)
        assert made.predicted is not None  # the master is implicit
        # Of what was not iterated the two are equal.
        difference = made.predicted - coupling.state.values
        share = corrector / (predictor - corrector)
        return Attempt(made.iterations, difference * share, degree + 2.0)


class EnergyResidual:
    """Energy that the coupling creates in the step at every power bond, from the residual power at its end.

    Sadjina et al. 2017.

    One side works with its own effort and the flow that it assumed, the other with its own flow and the
    effort that it assumed; the difference of the two powers is created by the coupling. It grows over the
    step as the signals' node polynomial does, which gives its integral. The energy counts as an error of
    the effort: over the step and the flow (or its nominal size if that is larger). For Jacobi masters: where
    signals are interpolated both sides agree at the end. Sees only what is exchanged over power bonds.
    """

    def check(self, master: Master) -> None:
        refuse_interpolation("energy", "both sides", master)

    def attempt(self, coupling: Coupling, master: Master, time: float, length: float) -> Attempt:
        if coupling.state.history.lacks(coupling.wiring.degree):
            return StepDoubling().attempt(coupling, master, time, length)
        degree = effective_degree(coupling)
        nodes = extrapolation_nodes(coupling.state.history, degree)
        mean = nodes.integral(0.0, length) / (length * nodes(length))
        iterations = master.step(coupling, time, length).iterations
        assumed, rates = np.zeros_like(coupling.state.values), np.zeros_like(coupling.state.rates)
        evaluate(coupling.signals, length, assumed, rates)
        error = np.zeros_like(coupling.state.values)
        for bond in find_exchanged_bonds(coupling.wiring.system):
            effort, flow = coupling.wiring.number[bond.effort], coupling.wiring.number[bond.flow]
            e, f = coupling.state.values[effort], coupling.state.values[flow]
            residual = e * assumed[flow] - assumed[effort] * f
            error[effort] += mean * residual / max(abs(f), coupling.wiring.nominal[flow])
        return Attempt(iterations, error, degree + 1.0)


ESTIMATORS: dict[str, type[Estimator]] = {
    "step_doubling": StepDoubling,
    "schierz": Schierz,
    "predictor_corrector": PredictorCorrector,
    "energy": EnergyResidual,
}

__all__ = ["ESTIMATORS", "Attempt", "Estimator"]
