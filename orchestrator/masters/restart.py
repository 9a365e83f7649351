"""The past that a run does not have: steps of explicit masters after the start or an event.

Extrapolated signals need earlier values, and beginning at a lower degree would cost the whole run its
order. So the first steps are repeated with signals interpolated to the values that they arrived at. Linear
interpolation over one step, with a local error of its third order, is enough for signals of degree two;
Hermite signals need one such step for their fourth. Where a participant cannot be rolled back, the first step
is made in parts that begin very short and double.
"""

import numpy as np

from ..engine.coupling import Coupling
from ..engine.signals import extrapolate, interpolate
from ..engine.sweeps import SweepKind
from .protocol import MasterStep

# Each sweep makes one more order right, and passes rates one participant further.
SWEEPS = 8
UNCHANGED = 1e-12
# Doublings of the parts: what held signals miss falls with the square of the first, here to 2e-5.
DOUBLINGS = 8


def repeat_first_step(
    coupling: Coupling, kind: SweepKind, order: tuple[int, ...], time: float, step: float
) -> MasterStep:
    """Repeat the step by such sweeps, with signals through the end values found, until these stay.

    At most SWEEPS times: this is no converged iteration. Where a participant cannot be rolled back, once: in
    parts, or with signals of lower degree where one moves by steps of its own.
    """
    end, state, nominal = time + step, coupling.state, coupling.wiring.nominal
    history, degree = state.history, coupling.wiring.degree
    extrapolate(history, degree, coupling.signals)
    if not coupling.restorable:
        if history.count == 1 and coupling.divisible and coupling.wiring.connected.size:
            _grow(coupling, kind, order, time, step)
        else:
            coupling.sweep(kind, order, time, step)
        return MasterStep()
    with coupling.points.rollback(order) as roll_back:
        for count in range(1, SWEEPS + 1):
            if count > 1:
                roll_back()
                interpolate(history, degree, end, state.values, state.rates, coupling.signals)
            before = state.values.copy()
            coupling.sweep(kind, order, time, step)
            if np.all(np.abs(state.values - before) <= UNCHANGED * (nominal + np.abs(state.values))):
                break
    return MasterStep(count)


def _grow(coupling: Coupling, kind: SweepKind, order: tuple[int, ...], time: float, step: float) -> None:
    """Make the step in parts, each as long as all before it; the signals are those of the first."""
    history, degree = coupling.state.history, coupling.wiring.degree
    begin = time
    for end in time + step * 2.0 ** np.arange(-DOUBLINGS, 1.0):
        if begin > time:
            coupling.accept(begin)
            extrapolate(history, degree, coupling.signals)
        coupling.sweep(kind, order, begin, end - begin)
        begin = end
