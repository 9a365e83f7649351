"""Predictor against corrector: what an iterated step's first sweep arrived at, and its last."""

from ...engine.coupling import Coupling
from ...masters import Master
from .nodes import effective_degree, extrapolation_nodes, interpolation_nodes
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
