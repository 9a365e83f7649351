"""The past that a run does not have: steps of explicit masters after the start or an event.

Extrapolated signals need earlier values, and beginning at a lower degree would cost the whole run its
order. So the first steps are repeated with signals interpolated to the values that they arrived at. Linear
interpolation over one step, with a local error of its third order, is enough for signals of degree two;
Hermite signals need one such step for their fourth.
"""

from __future__ import annotations

import numpy as np

from ..engine.coupling import Coupling
from ..engine.signals import extrapolate, interpolate
from ..engine.sweeps import SweepKind
from .protocol import MasterStep

# Each sweep makes one more order right, and passes rates one participant further.
SWEEPS = 8
UNCHANGED = 1e-12


def repeat_first_step(
    coupling: Coupling, kind: SweepKind, order: tuple[int, ...], time: float, step: float
) -> MasterStep:
    """Repeat the step by such sweeps, with signals through the end values found, until these stay.

    At most SWEEPS times: this is no converged iteration. Once, with signals of lower degree, where a
    participant cannot be rolled back.
    """
    end, state, nominal = time + step, coupling.state, coupling.wiring.nominal
    history, degree = state.history, coupling.wiring.degree
    extrapolate(history, degree, coupling.signals)
    if not coupling.restorable:
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
