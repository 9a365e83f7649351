"""Macro steps for participants without a way back: each is as long as the ones before it allow.

The defect, |y - u| of an output and the signal that went on from its past, needs no more of a participant
than its outputs (Kyllingstad, Sadjina and Skjong 2024, arXiv 2406.17353). It sees what a signal has missed,
not what that did inside of a participant.
"""

from dataclasses import asdict
from typing import Any

import numpy as np

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.signals import evaluate, extrapolate
from ..engine.step import ERROR, GROWTH, LONGEST, STOP, TIME_EVENT, Step
from ..masters import Master
from ..masters.gauss_seidel import GaussSeidel, resolve_order
from .controlled import GROW, PI, StepControl
from .estimators import effective_degree
from .guard import RunawayGuard

# Steps this near to the end (relative) go there.
ENDING = 1e-9
# The first step, of the one that is given: signals have no past there and are held.
FIRST = 0.01
# Steps stay as long as they are while the error asks for no less than this factor, and until it allows GROW,
# as in DASSL. With equal steps, errors of both signs cancel over a period of the motion; steps that follow
# the error within the period lose that.
KEPT = 0.75


class ForwardSteps:
    """Takes every step that it makes, and chooses the next one by its defect.

    An error is known only when it has been made: a jump, or the closing of a contact, may be missed by any
    amount within one step, and no event is located. The defect falls with the power k + 1 of the step,
    k being the degree of the signals, or 1 where an FMU holds its inputs.
    """

    locates = False

    def __init__(self, first_step: float, control: StepControl) -> None:
        self._control, self._next, self._set_by = control, FIRST * first_step, GROWTH
        self._controller = PI()

    def begin(self, coupling: Coupling, master: Master, start: float, stop: float) -> None:
        self._coupling, self._master, self._stop = coupling, master, stop
        self._extrapolated = find_extrapolated(coupling, master)
        self._guard = RunawayGuard(coupling, master)
        self._signals = np.zeros_like(coupling.signals)
        self._assumed, self._rates = np.zeros(self._signals.shape[1]), np.zeros(self._signals.shape[1])

    def step(self, time: float) -> Step:
        coupling, history = self._coupling, self._coupling.state.history
        length, end, reason = self._propose(time)
        degree = min(effective_degree(coupling), history.count - 1 if history.lacks(3) else 3)
        self._signals[:] = 0.0
        extrapolate(history, degree, self._signals[: degree + 1])
        evaluate(self._signals, length, self._assumed, self._rates)
        iterations = self._master.step(coupling, time, length).iterations
        error, source = 0.0, -1
        if coupling.wiring.connected.size:
            parts = self._measure_defects()[coupling.wiring.connected]
            error = float(np.sqrt(np.mean(parts**2)))
            source = int(coupling.wiring.connected[np.argmax(parts)])
        self._guard.judge(end, length)
        coupling.accept(end)
        self._choose(length, error, degree + 1.0)
        return Step(end, length, iterations, 0, error, coupling.wiring.output_number(source), reason)

    def _measure_defects(self) -> Vector:
        """Of each source at the end of the step, over what is allowed; only signals that somebody followed
        into the unknown count."""
        values, assumed, control = self._coupling.state.values, self._assumed, self._control
        size = np.maximum(np.abs(values), np.abs(assumed))
        allowed = control.absolute * self._coupling.wiring.nominal + control.relative * size
        return np.where(self._extrapolated, np.abs(values - assumed) / allowed, 0.0)

    def _propose(self, time: float) -> tuple[float, float, int]:
        """The length of the step, where it ends, and what sets it."""
        end, why = self._stop, STOP
        if (event := self._coupling.instants.next_event(time)) < end:
            end, why = event, TIME_EVENT
        left = end - time
        if self._next >= left * (1.0 - ENDING):
            return left, end, why
        # Two equal steps rather than one and a remainder.
        length = min(self._next, 0.5 * left) if self._next > 0.5 * left else self._next
        return length, time + length, self._set_by

    def _choose(self, length: float, error: float, exponent: float) -> None:
        """Set the next step."""
        control, controller = self._control, self._controller
        if error > 1.0:
            factor = controller.instead(error, exponent)
            self._controller = PI()
        else:
            factor = controller.after(error, exponent, length)
            if KEPT <= controller.allowed(controller.error, exponent) < GROW:
                factor = 1.0
        self._set_by = GROWTH if factor >= GROW else ERROR
        self._next = max(length * factor, control.minimum_step)
        if self._next >= control.maximum_step:
            self._next, self._set_by = control.maximum_step, LONGEST

    def state(self) -> dict[str, Any]:
        return {
            "next": self._next,
            "set_by": self._set_by,
            "controller": asdict(self._controller),
            "guard": self._guard.state(),
        }

    def resume(self, state: dict[str, Any]) -> None:
        self._next, self._set_by = float(state["next"]), int(state["set_by"])
        self._controller = PI(**state["controller"])
        self._guard.resume(state["guard"])


def find_extrapolated(coupling: Coupling, master: Master) -> Any:
    """The sources whose signals the master extrapolates for somebody: with Gauss-Seidel those that go to a
    participant before their own."""
    wiring = coupling.wiring
    if not isinstance(master, GaussSeidel):
        found = np.zeros(len(wiring.sources), dtype=np.bool_)
        found[wiring.connected] = True
        return found
    order = resolve_order(coupling, master.order)
    found = np.zeros(len(wiring.sources), dtype=np.bool_)
    for turn, i in enumerate(order):
        for later in order[turn:]:
            own = wiring.slices[later]
            found[[c for c in wiring.columns[i] if own.start <= c < own.stop]] = True
    return found
