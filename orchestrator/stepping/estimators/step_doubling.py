"""Step doubling: the step once as a whole and once in two halves."""

import numpy as np

from models.core.quantities import Vector

from ...engine.coupling import Coupling
from ...masters import Master
from .nodes import effective_degree, extrapolation_nodes
from .protocol import Attempt


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
