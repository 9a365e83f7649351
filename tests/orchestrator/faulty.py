"""A participant with faults put in, alone and in runs of two masses with all kinds of steps."""

import functools
import random
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import numpy as np

from orchestrator.errors import DiscardedStepError, LostParticipantError, RecoverableError, RunError
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.participants.compiled_calls import NotCompiledError
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.participants.protocol import BoundVariables
from orchestrator.stepping import ControlledSteps, StepControl

from .coupled import Recorder, run_coupled
from .two_masses import exact, two_masses

# Says of the n-th call of `advance`, with its time and step, whether the fault comes.
When = Callable[[float, float, int], bool]


def longer_than(limit: float) -> When:
    return lambda time, step, n: step > limit * (1.0 + 1e-9)


def every(number: int) -> When:
    return lambda time, step, n: n % number == 0


def at_random(share: float, seed: int) -> When:
    draw = random.Random(seed)
    return lambda time, step, n: draw.random() < share


def after(start: float) -> When:
    return lambda time, step, n: time >= start - 1e-12


def never(time: float, step: float, n: int) -> bool:
    return False


class Faulty:
    """Implements `Participant` by `inner`.

    A discarded step has not begun, or with `arrives` it has got to that part of it. `fails` spoils the
    state (only `restore` mends it). `value(time, name, value)` is what is read instead. `drift` is what its
    clock gains relative to true time.
    """

    def __init__(
        self,
        inner: Any,
        *,
        discards: When = never,
        arrives: float = 0.0,
        silent: bool = False,
        fails: When = never,
        dies: When = never,
        value: Callable[[float, str, float], float] | None = None,
        drift: float = 0.0,
    ) -> None:
        self.name, self._inner = inner.name, inner
        self._discards, self._arrives, self._silent = discards, arrives, silent
        self._fails, self._dies = fails, dies
        self._value, self._drift = value, 1.0 + drift
        self._time, self._broken = 0.0, False
        self.calls: list[tuple[float, float]] = []
        self.saved = self.released = 0
        self.closed = False

    def __getattr__(self, name: str) -> Any:
        return getattr(self._inner, name)

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        self._output_names, self._outputs = bound.output_names, bound.outputs
        return list(self._inner.connect(bound))

    def compiled_calls(self) -> NoReturn:
        raise NotCompiledError("its faults are in Python")

    def write(self) -> None:
        self._inner.write()

    def advance(self, time: float, step: float) -> None:
        assert not self._broken, "advanced after a failure, without restoring"
        self.calls.append((time, step))
        n, what = len(self.calls), f"{self.name}: step from t = {time:.9g} s by {step:g} s"
        if self._dies(time, step, n):
            self._broken = True
            raise LostParticipantError(f"{what} returned Fatal: dead")
        if self._fails(time, step, n):
            self._inner.advance(time, 0.3 * step)
            self._broken = True
            raise RecoverableError(f"{what} returned Error: failed")
        if self._discards(time, step, n):
            if self._arrives:
                self._inner.advance(time, self._arrives * step)
            reached = None if self._silent else time + self._arrives * step
            raise DiscardedStepError(f"{what} returned Discard: not now", reached)
        self._inner.advance(time * self._drift, step * self._drift)
        self._time = time + step

    def read(self) -> None:
        self._inner.read()
        if self._value:
            for i, name in enumerate(self._output_names):
                self._outputs[i] = self._value(self._time, name, self._outputs[i])

    def save(self) -> Any:
        self.saved += 1
        return self._time, self._inner.save()

    def restore(self, saved: Any) -> None:
        self._time, self._broken = saved[0], False
        self._inner.restore(saved[1])

    def release(self, saved: Any) -> None:
        self.released += 1
        self._inner.release(saved[1])

    def close(self) -> None:
        self.closed = True
        self._inner.close()


STOP = 1.0

# Step control over explicit and implicit masters, by every estimator that suits two masses.
CONTROLLED = {
    "jacobi, step_doubling": (Jacobi("quadratic"), "step_doubling"),
    "gauss_seidel, step_doubling": (GaussSeidel("quadratic"), "step_doubling"),
    "iterated, predictor_corrector": (Iterated("hermite"), "predictor_corrector"),
}
TOLERANCE = 1e-5


def controlled(second, kind, minimum_step=1e-7):
    """The recorder of a run with step control, and the error that ended it."""
    master, estimator = CONTROLLED[kind]
    control = StepControl(
        estimator, relative=TOLERANCE, absolute=TOLERANCE, minimum_step=minimum_step, maximum_step=0.05
    )
    return simulated(second, master, ControlledSteps(1e-3, control))


@functools.cache
def sound(kind):
    """The recorder of a run without faults."""
    recorder, ended = controlled(faulty(), kind)
    assert ended is None
    return recorder


def simulated(second, master, steps):
    system, recorder, ended = two_masses(), Recorder(), None
    units = {"first": Faulty(in_process("first", system.instances["first"])), "second": second}
    try:
        run_coupled(system, master, steps, STOP, recorder=recorder, **units)
    except RunError as error:
        ended = error
    assert recorder.ended == (ended is None, "" if ended is None else str(ended))
    for unit in units.values():
        if isinstance(unit, Faulty):
            assert unit.saved == unit.released
    return recorder, ended


def faulty(**faults):
    return Faulty(in_process("second", two_masses().instances["second"]), **faults)


def missed(recorder):
    truth = exact(recorder.times)
    return max(
        np.abs(recorder["first.position"] - truth[:, 0]).max(),
        np.abs(recorder["second.position"] - truth[:, 1]).max(),
    )
