"""The coupled run: macro steps from start to stop, watched by observers."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from models.quantities import Vector
from models.system import System

from .errors import RunError, UnstableCouplingError
from .exchange import Exchange
from .masters import MASTERS, Master
from .participants import Participant
from .signals import append_judged
from .start_up import probe_start


class Observer(Protocol):
    """Watches a run; algorithms never write files."""

    def begin(self, names: Sequence[str]) -> None:
        """Before the first values: the names of all outputs, "participant.variable"."""
        ...

    def observe(self, time: float, outputs: Callable[[], Vector], iterations: int) -> None:
        """At the start (iterations 0) and after each macro step.

        `outputs()` gives all outputs at `time`, in memory that is reused. They are read when the first
        observer asks: a step that nobody records costs no reading.
        """
        ...

    def end(self, complete: bool, message: str) -> None:
        """After the last values, also when the run failed or was interrupted."""
        ...


@dataclass(frozen=True)
class Statistics:
    """What a run took."""

    macro_steps: int
    rejected_steps: int
    iterations: int
    coupled_time_s: float


class LatestOutputs:
    """All outputs of all participants after the latest step, read once, when they are asked for."""

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange
        self._values = np.zeros(exchange.system.outputs.size)
        self._read = False

    def outdate(self) -> None:
        """A step has been made."""
        self._read = False

    def __call__(self) -> Vector:
        if not self._read:
            self._exchange.read_all(self._values)
            self._read = True
        return self._values


class RunawayGuard:
    """Names an unstable explicit coupling before it ends in numbers that are not finite.

    It judges the exchanged values, which the master reads in every step.

    An explicit master is right only where exchanged values follow their own prediction. Where they swing
    with the macro step itself, or a contact bounces within single steps, the sum of what they miss their
    linear extrapolation by, over the last WINDOW steps or so, is as large as the values themselves (or
    their nominal sizes, if those are larger): more than SHARE of it is a runaway. An impact misses in one
    or two steps of a window and passes. Any master: a value of BOUND nominal sizes is a runaway.
    """

    WINDOW = 50
    FIRST = 10  # steps that are not judged: a start in motion rings
    SHARE = 0.5
    BOUND = 1e9

    def __init__(self, exchange: Exchange, master: Master) -> None:
        self._exchange = exchange
        self._master = master
        self._missed = np.zeros(len(exchange.sources))
        self._size = np.zeros(len(exchange.sources))
        self._patience = math.inf if master.implicit else self.FIRST
        self._keep = 1.0 - 1.0 / self.WINDOW

    def append(self, time: float, step: float) -> None:
        """Put the values after `step` at `time` into the history; UnstableCouplingError for a runaway."""
        e, past = self._exchange, self._exchange.history
        self._patience -= 1
        worst = append_judged(
            past.times,
            past.values,
            past.count,
            time,
            e.values,
            e.nominal,
            self._keep,
            self.BOUND,
            self.SHARE if self._patience < 0 else math.inf,
            self._missed,
            self._size,
        )
        past.appended()
        if worst >= 0:
            raise UnstableCouplingError(
                f"{e.sources[worst]}: unstable coupling at t = {time:.6g} s: its values do not follow their "
                f"own prediction any more; {_name(self._master)} cannot couple this system with steps "
                f"of {step:g} s: reduce macro_step, or use the iterated master"
            )


def simulate(
    system: System,
    participants: Mapping[str, Participant],
    master: Master,
    macro_step: float,
    stop_time: float,
    observers: Sequence[Observer] = (),
    start_time: float = 0.0,
) -> Statistics:
    """Step `participants` (by instance name) from `start_time` to `stop_time` with `master`.

    The last step is shortened to end at `stop_time`. RunError says what went wrong; observers have then
    seen everything up to the last good step. Participants are not closed.
    """
    if not macro_step > 0.0:
        raise RunError(f"macro_step = {macro_step:g} s: must be > 0")
    if not stop_time > start_time:
        raise RunError(f"stop_time = {stop_time:g} s: must be after the start at {start_time:g} s")
    exchange = Exchange(system, participants, master.degree)
    outputs = LatestOutputs(exchange)
    steps = iterations = 0
    message, complete = "", False
    for observer in observers:
        observer.begin(system.outputs.names)
    began = clock.perf_counter()
    try:
        exchange.initialise(start_time, stop_time)
        probe_start(exchange, start_time, min(macro_step, stop_time - start_time))
        began = clock.perf_counter()
        guard = RunawayGuard(exchange, master)
        _show(observers, start_time, outputs, 0)
        # Times are multiples of the step: a sum of steps would drift.
        total = max(1, round((stop_time - start_time) / macro_step - 1e-9 + 0.5))
        time = start_time
        for n in range(1, total + 1):
            end = stop_time if n == total else start_time + n * macro_step
            used = master.step(exchange, time, end - time)
            guard.append(end, end - time)
            time, steps, iterations = end, n, iterations + used
            _show(observers, time, outputs, used)
        complete = True
    except KeyboardInterrupt:
        message = "interrupted"
        raise
    except Exception as error:
        message = str(error)
        raise
    finally:
        elapsed = clock.perf_counter() - began
        for observer in observers:
            observer.end(complete, message)
    return Statistics(steps, 0, iterations, elapsed)


def _show(observers: Sequence[Observer], time: float, outputs: LatestOutputs, iterations: int) -> None:
    outputs.outdate()
    for observer in observers:
        observer.observe(time, outputs, iterations)


def _name(master: Master) -> str:
    """The master as a scenario names it."""
    return next((name for name, kind in MASTERS.items() if isinstance(master, kind)), type(master).__name__)
