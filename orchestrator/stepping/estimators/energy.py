"""Energy residual: power that the coupling creates at the end of a step (Sadjina et al. 2017)."""

import numpy as np

from ...engine.coupling import Coupling
from ...engine.energy.bonds import find_exchanged_bonds
from ...engine.signals import evaluate
from ...masters import Master
from .nodes import effective_degree, extrapolation_nodes
from .protocol import Attempt, refuse_interpolation
from .step_doubling import StepDoubling


class EnergyResidual:
    """Energy that the coupling creates in the step at every power bond, from the residual power at its end.

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
