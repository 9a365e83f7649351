"""Macro steps as long as a tolerance on their local error allows.

What the error estimate of an explicit step can't see: a change of inputs that no participant was given.

An estimator compares ways through the step that extrapolate the same past. Where a value leaves its past in
the step, a contact force say that was zero all the time, all of these ways carry the same wrong input and
agree. So the outputs are asked for at the end of the step, with the inputs there; where one of them has left
the parabola through its past, the step is made once more with signals that go to these values.
"""

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.coupling_state import SavedPoint
from ..engine.signals import History, interpolate, parabola
from ..engine.step import (
    CONVERGENCE,
    DISCARD,
    ERROR,
    EVENT,
    GROWTH,
    LONGEST,
    SHORTEST,
    STOP,
    TIME_EVENT,
    Step,
)
from ..engine.sweeps import JACOBI
from ..errors import EndedError, NonConvergenceError, RecoverableError, RunError, one_of
from ..masters import Master, find_name
from .estimators import ESTIMATORS, Attempt
from .locator import Locator

# The error aimed at, over what is allowed: at order five a sixth of the length away from a rejection.
AIM = 0.4
# A length changes by these factors at most.
SHRINK, GROW = 0.2, 2.0
# Gains of the proportional-integral controller, over the order (Gustafsson 1991).
INTEGRAL, PROPORTIONAL = 0.3, 0.4
# Steps as long as the one in which an error was seen that go by before it counts 1/e of its size.
MEMORY = 3.0
# An estimate far below the tolerance is rounding.
SMALLEST = 1e-6


@dataclass
class PI:
    """Proportional-integral control by the largest error of the last few steps.

    Errors are estimates over what is allowed, `exponent` P of error ~ H^P. Where a part rings, the estimate
    passes through zero twice a period, and steps that follow it grow too long there and are rejected
    thereafter. So an error is remembered, in proportion to H^P, and fades with the time that passes: within
    steps of the length in which it was seen, which is fast where steps grow again after an event.
    """

    error: float = 0.0
    length: float = 1.0
    seen: float = 1.0
    previous: float = AIM

    def after(self, error: float, exponent: float, length: float) -> float:
        """Factor for the length of the next step after one of `length` with `error` <= 1."""
        faded = math.exp(-length / (MEMORY * self.seen))
        remembered = self.error * (length / self.length) ** exponent * faded
        if error >= remembered:
            self.seen = length
        self.error, self.length = max(error, remembered, SMALLEST), length
        integral = (AIM / self.error) ** (INTEGRAL / exponent)
        proportional = (self.previous / self.error) ** (PROPORTIONAL / exponent)
        self.previous = self.error
        return min(GROW, max(SHRINK, integral * proportional))

    def allowed(self, error: float, exponent: float) -> float:
        """Factor to the length that the error aimed at allows, by its order alone."""
        return (AIM / max(error, SMALLEST)) ** (1.0 / exponent)

    def instead(self, error: float, exponent: float) -> float:
        """Factor for the length of another attempt after one with `error` > 1."""
        return max(SHRINK, self.allowed(error, exponent))


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


# After an attempt that failed.
FAILED = 0.25
# After a restart (event, discontinuity): of the length before it.
RESTARTED = 0.1
# Steps over the tolerance in a row, at the shortest length, that pass as a discontinuity.
DISCONTINUITY = 5

# Names of what judges steps: those that may be made again, and those that are made once.
DEFECT = "defect"
JUDGES = (*ESTIMATORS, DEFECT)


def check_estimator(name: str, master: Master) -> None:
    """ValueError, with the remedy, if this estimator cannot judge that master."""
    if name == "predictor_corrector" and not master.implicit:
        raise ValueError(
            f"estimator = {name!r}: needs a master that corrects; use iterated, or step_doubling"
        )
    if name == DEFECT and master.implicit:
        raise ValueError(
            f"estimator = {name!r}: judges steps that are made once; {find_name(master)} repeats them: use "
            "predictor_corrector or step_doubling"
        )


@dataclass(frozen=True)
class StepControl:
    """Tolerances and limits. An error is allowed `absolute` of nominal + `relative` of the value.

    `minimum_step` and `maximum_step` in s; `event_tolerance` (s) is how well events are located.
    """

    estimator: str
    relative: float = 1e-4
    absolute: float = 1e-4
    minimum_step: float = 1e-12
    maximum_step: float = math.inf
    event_tolerance: float = 1e-9

    def __post_init__(self) -> None:
        if self.estimator not in JUDGES:
            raise ValueError(f"estimator = {self.estimator!r}: {one_of(JUDGES, self.estimator)}")
        for name in ("relative", "absolute", "minimum_step", "maximum_step", "event_tolerance"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} = {getattr(self, name):g}: must be > 0")
        if self.minimum_step > self.maximum_step:
            raise ValueError(
                f"minimum_step = {self.minimum_step:g} s: must not be longer than maximum_step = "
                f"{self.maximum_step:g} s"
            )


@dataclass
class _Trial:
    """A step that is tried: `length`, then `gap` to cross an event, to `end`; `reason` sets its length.

    `event` is the source of an event that was located in it, or -1; `rejected` why it was not made.
    """

    length: float
    gap: float
    end: float
    reason: int
    attempt: Any = None
    error: float = 0.0
    source: int = -1
    event: int = -1
    rejected: int | None = None


class ControlledSteps:
    """Attempts a step, estimates its error, and accepts it or goes back and takes a shorter one."""

    locates = True

    def __init__(self, first_step: float, control: StepControl) -> None:
        self._control = control
        self._attempt_step = ESTIMATORS[control.estimator]
        self._controller = PI()
        self._next = first_step  # what the error allows, or growth from what it allowed before
        self._set_by = GROWTH  # which of the two
        self._over = 0  # steps over the tolerance in a row

    def begin(self, coupling: Coupling, master: Master, start: float, stop: float) -> None:
        check_estimator(self._control.estimator, master)
        self._coupling, self._master, self._stop = coupling, master, stop
        self._locator = Locator(coupling, self._control.event_tolerance)

    def step(self, time: float) -> Step:
        rejected, why, early = 0, ERROR, self._master.implicit
        with self._coupling.points.keep() as saved:
            while (trial := self._try(saved, time, early)).rejected is not None:
                rejected, why = rejected + 1, trial.rejected
                # After a failure over an event, this step was too long to see where the event is.
                early &= why not in (CONVERGENCE, DISCARD) or trial.error <= 1.0
        if rejected and trial.reason in (ERROR, GROWTH):
            trial.reason = why
        smooth: Any = False
        if trial.gap:
            smooth = ~self._locator.bent(trial.end, trial.event)
            reached, before = time + trial.length, saved.coupling.values
            if trial.length:
                self._coupling.accept(reached)
            jumped = before if trial.reason == EVENT else None
            trial.gap = self._locator.cross(self._master, reached, trial.gap, jumped)
        if trial.event >= 0:
            trial.source, trial.end = trial.event, time + trial.length + trial.gap
            self._locator.last = trial.end
        return self._accept(time, trial, smooth, rejected)

    def _try(self, saved: SavedPoint, time: float, early: bool) -> _Trial:
        """Make a step, or else go back to its start and propose another length.

        `early`: an event is looked for in a step whose estimated error is too large, too.
        """
        coupling, shortest = self._coupling, self._control.minimum_step
        trial = _Trial(*self._propose(time))
        coupling.state.history.end_smooth[:] = ~self._locator.bent(trial.end)
        try:
            self._make(saved, time, trial, early)
            if trial.error <= 1.0 or trial.length <= shortest:
                return trial
            trial.rejected = ERROR
        except (NonConvergenceError, RecoverableError) as failure:
            trial.rejected = CONVERGENCE if isinstance(failure, NonConvergenceError) else DISCARD
            if trial.error <= 1.0:
                self._go_back(saved, trial.length, failure)
                return trial
        except EndedError as ended:
            if not (ended.inside(time) and ended.reached < time + trial.length):
                raise
            coupling.points.restore(saved)
            trial.rejected = self._set_by = STOP
            self._next = ended.reached - time
            return trial
        coupling.points.restore(saved)
        shorter = trial.length * self._controller.instead(trial.error, trial.attempt.exponent)
        self._next, self._set_by = max(shortest, shorter), ERROR
        return trial

    def _make(self, saved: SavedPoint, time: float, trial: _Trial, early: bool) -> None:
        """Attempt the step, and end it where an event is located in it."""
        coupling, before = self._coupling, saved.coupling.values
        trial.attempt = self._attempt(saved, time, trial.length)
        trial.error, trial.source = self._norm(before, trial.attempt.error)
        # A step over an event has a large estimate, from what jumps or bends there, before the event is
        # located. (After an explicit step with such an error nothing may be right.)
        met = early and self._locator.find_event(before) >= 0
        if not (trial.error <= 1.0 or trial.length <= self._control.minimum_step or met):
            return

        def again(shorter: float) -> None:
            coupling.points.restore(saved)
            trial.attempt = self._attempt_step(coupling, self._master, time, shorter)

        length, over, trial.event = self._locator.locate(saved, time, trial.length, again)
        if length < trial.length:
            trial.length, trial.gap, trial.end, trial.reason = length, over, time + length + over, EVENT
            trial.error, trial.source = self._norm(before, trial.attempt.error)
        if length == 0.0:
            coupling.points.restore(saved)
            trial.error = 0.0

    def _propose(self, time: float) -> tuple[float, float, float, int]:
        """Length of the next attempt, how long to cross what then comes, where that ends, what sets it."""
        control = self._control
        length, reason = self._next, self._set_by
        if length >= control.maximum_step:
            length, reason = control.maximum_step, LONGEST
        end, why, crossed = self._locator.ahead(time), TIME_EVENT, True
        if (event := self._coupling.instants.next_event(time)) <= end:
            end, crossed = event, False
        # An event that but for rounding is at the stop leaves no step behind it.
        if self._stop - end <= 4.0 * math.ulp(end):
            end, why = self._stop, STOP
        left = end - time
        if length >= left * (1.0 - 1e-9):
            gap = min(self._locator.tolerance, 0.5 * left) if why == TIME_EVENT and crossed else 0.0
            return left - gap, gap, end, why
        # Two equal steps rather than one and a remainder.
        if length > 0.5 * left:
            length = 0.5 * left
        return length, 0.0, time + length, reason

    def _go_back(self, saved: SavedPoint, length: float, error: RunError) -> None:
        """Back to the start of the step for a shorter attempt; the error itself if there is none left."""
        self._coupling.points.restore(saved)
        self._coupling.state.warm_starts = {}
        self._next = max(self._control.minimum_step, FAILED * length)
        self._set_by = GROWTH  # from this length on
        if length <= self._control.minimum_step:
            raise type(error)(f"{error} (also with the shortest step of {length:g} s)") from error

    def _norm(self, before: Vector, error: Vector) -> tuple[float, int]:
        """Root mean square of the errors over what is allowed, and the source with the largest."""
        e = self._coupling
        parts = (np.abs(error) / self._allowed(before))[e.wiring.connected]
        if not parts.size:
            return 0.0, -1
        return float(np.sqrt(np.mean(parts**2))), int(e.wiring.connected[np.argmax(parts)])

    def _attempt(self, saved: SavedPoint, time: float, length: float) -> Attempt:
        attempt = self._attempt_step(self._coupling, self._master, time, length)
        if self._master.implicit:
            return attempt
        allowed = self._allowed(saved.coupling.values)
        return include_unseen_error(self._coupling, saved, time, length, attempt, allowed)

    def _allowed(self, before: Vector) -> Vector:
        e, control = self._coupling, self._control
        sizes = np.maximum(np.abs(before), np.abs(e.state.values))
        return np.asarray(control.absolute * e.wiring.nominal + control.relative * sizes)

    def _accept(self, time: float, trial: _Trial, smooth: Any, rejected: int) -> Step:
        """A step to the trial's end, of which its length has the estimated error.

        `smooth`: the sources whose rates hold after an event that was crossed; False for none.
        """
        coupling, attempt, error, source = self._coupling, trial.attempt, trial.error, trial.source
        length, end, reason = trial.length, trial.end, trial.reason
        discontinuous = error > 1.0
        self._over = self._over + 1 if discontinuous else 0
        if self._over > DISCONTINUITY:
            raise RunError(
                f"{coupling.wiring.sources[source]}: the error of the coupling stays {error:.2g} times over "
                f"the tolerance at t = {time:.9g} s with the shortest step of {length:g} s; lower "
                "minimum_step, or relax [step_control]'s tolerances"
            )
        coupling.accept(end)
        if discontinuous:
            reason = SHORTEST
        factor = self._controller.after(min(error, 1.0), attempt.exponent, length)
        if rejected:
            factor = min(factor, 1.0)
        grown = length * factor
        # A step cut short by an event or the stop says nothing against the length proposed before it.
        if length >= self._next or grown > self._next:
            # Where the error would allow as much as the largest growth, it sets nothing.
            growing = self._controller.allowed(self._controller.error, attempt.exponent) >= GROW
            self._next, self._set_by = grown, GROWTH if growing else ERROR
        if smooth is not False or discontinuous or self._locator.due(end):
            coupling.state.history.restart(smooth)
            coupling.state.warm_starts = {}
            self._controller = PI()
            self._next, self._set_by = RESTARTED * self._next, GROWTH
        self._next = min(max(self._next, self._control.minimum_step), self._control.maximum_step)
        number = coupling.wiring.output_number(source)
        parts = attempt.parts if length else 1
        return Step(end, end - time, attempt.iterations, rejected, error, number, reason, parts)

    def state(self) -> dict[str, Any]:
        return {
            "next": self._next,
            "set_by": self._set_by,
            "over": self._over,
            "controller": asdict(self._controller),
            "last": self._locator.last,
        }

    def resume(self, state: dict[str, Any]) -> None:
        self._next, self._over = float(state["next"]), int(state["over"])
        self._set_by = int(state["set_by"])
        self._controller = PI(**state["controller"])
        self._locator.last = float(state["last"])
