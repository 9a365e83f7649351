"""What the error estimate of an explicit step can't see: a change of inputs that no participant was given.

An estimator compares ways through the step that extrapolate the same past. Where a value leaves its past in
the step, a contact force say that was zero all the time, all of these ways carry the same wrong input and
agree. So the outputs are asked for at the end of the step, with the inputs there; where one of them has left
the parabola through its past, the step is made once more with signals that go to these values.
"""

from dataclasses import replace

import numpy as np

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.saved_points import SavedPoint
from ..engine.signals import History, interpolate, parabola
from ..engine.sweeps import JACOBI
from .estimators import Attempt

# A value has left its past where it misses the parabola by this share of how far it has moved.
LEFT = 0.5
# Next to a bend a step's error falls with the square of its length.
BENT = 2.0


def include_unseen_error(
    coupling: Coupling, saved: SavedPoint, time: float, length: float, attempt: Attempt, allowed: Vector
) -> Attempt:
    """The attempt, with the error that its estimator can't see; the coupling is then at its end, as before.

    `allowed` is what every source may be wrong by, `saved` the start of the step.
    """
    state, before, every = coupling.state, saved.coupling, coupling.wiring.all
    end, end_time = coupling.points.save(), time + length
    try:
        coupling.settle(every, end_time)
        values, rates = state.values.copy(), state.rates.copy()
        missed = np.abs(values - predict(before.history, end_time))
        moved = np.maximum(np.abs(values - before.values), np.ptp(before.history.values, axis=0))
        left = (missed > LEFT * moved) & (missed > allowed)
        if left[coupling.wiring.connected].any():
            coupling.points.restore(saved)
            interpolate(state.history, coupling.wiring.degree, end_time, values, rates, coupling.signals)
            coupling.sweep(JACOBI, every, time, length)
            unseen = np.abs(state.values - values)
            if np.any(unseen > np.abs(attempt.error)):
                attempt = replace(attempt, error=np.maximum(unseen, np.abs(attempt.error)), exponent=BENT)
        coupling.points.restore(end)
    finally:
        coupling.points.release(end)
    return attempt


def predict(history: History, time: float) -> Vector:
    """The values at `time` by the parabola through the known points, or what fewer of them give."""
    (t0, t1, t2), points = history.times, history.count
    return np.array([parabola(t0, v0, t1, v1, t2, v2, points, time)[0] for v0, v1, v2 in history.values.T])
