"""The modified estimate of Schierz, Arnold and Clauss 2012 (doi 10.3384/ecp12076205), section 4."""

from ...engine.coupling import Coupling
from ...engine.signals import move_origin
from ...engine.sweeps import JACOBI
from ...masters import Master
from .nodes import effective_degree
from .protocol import Attempt, refuse_interpolation
from .step_doubling import StepDoubling, exponent, ratios


class Schierz:
    """Two halves of a step; the second one also with the first one's signals going on.

    Needs no way back over the whole step, only over its second half. Error = (fresh - continued) / (1 - p),
    see `step_doubling`. For Jacobi masters, where every signal is extrapolated: one that interpolates some
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
