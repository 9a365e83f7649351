"""The coupled run: macro steps from start to stop, watched by observers."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from models.quantities import Vector
from models.system import System

from .errors import RunError, UnstableCouplingError
from .exchange import Exchange
from .masters import Master
from .participants import Participant
from .signals import misses
from .start_up import probe_start


class Observer(Protocol):
    """Watches a run; algorithms never write files."""

    def begin(self, names: Sequence[str]) -> None:
        """Before the first values: the names of all outputs, "participant.variable"."""
        ...

    def observe(self, time: float, outputs: Vector, iterations: int) -> None:
        """All outputs at the start (iterations 0) and after each macro step. The array is reused."""
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


class RunawayGuard:
    """Names an unstable coupling before it ends in numbers that are not finite.

    In a stable, resolved run exchanged values follow their own linear prediction. A value is running
    away when it misses that by more than its nominal size and its amplitude so far in PATIENCE
    consecutive steps (so it swings with the macro step itself; an impact does so in a few steps only) and
    its amplitude has grown by GROWTH meanwhile (a stable oscillation that is too fast for the step has
    not), or when it has reached BOUND nominal sizes, however smoothly.
    """

    PATIENCE = 20
    GROWTH = 2.0
    BOUND = 1e9

    def __init__(self, exchange: Exchange, master: Master) -> None:
        self._exchange = exchange
        self._master = master
        self._amplitude = np.maximum(exchange.nominal, np.abs(exchange.values))
        self._before = self._amplitude.copy()
        self._misses = np.zeros(len(exchange.sources), dtype=np.int64)
        self._missed = np.zeros(len(exchange.sources), dtype=np.bool_)

    def check(self, time: float, step: float) -> None:
        """Compare the new values with the prediction; UnstableCouplingError if one runs away."""
        e = self._exchange
        past = e.history
        end = time + step
        if not misses(past.times, past.values, past.count, end, e.values, self._amplitude, self._missed):
            self._misses[:] = 0
            return
        self._misses = np.where(self._missed, self._misses + 1, 0)
        self._before = np.where(self._misses <= 1, self._amplitude, self._before)
        self._amplitude = np.maximum(self._amplitude, np.abs(e.values))
        swinging = (self._misses >= self.PATIENCE) & (self._amplitude > self.GROWTH * self._before)
        runaway = swinging | (self._amplitude > self.BOUND * e.nominal)
        if runaway.any():
            worst = e.sources[int(np.argmax(np.where(runaway, self._amplitude / e.nominal, 0.0)))]
            raise UnstableCouplingError(
                f"{worst}: unstable coupling at t = {time:.6g} s: its exchanged values grow without "
                f"bound; {self._master} cannot couple this system with steps of {step:g} s: reduce "
                "macro_step, or use the iterated master with linear signals"
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
    outputs = np.zeros(system.outputs.size)
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
        _show(observers, exchange, start_time, outputs, 0)
        # Times are multiples of the step: a sum of steps would drift.
        total = max(1, round((stop_time - start_time) / macro_step - 1e-9 + 0.5))
        time = start_time
        for n in range(1, total + 1):
            end = stop_time if n == total else start_time + n * macro_step
            used = master.step(exchange, time, end - time)
            guard.check(time, end - time)
            exchange.history.append(end, exchange.values)
            time, steps, iterations = end, n, iterations + used
            _show(observers, exchange, time, outputs, used)
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


def _show(
    observers: Sequence[Observer], exchange: Exchange, time: float, outputs: Vector, iterations: int
) -> None:
    if observers:
        exchange.read_all(outputs)
        for observer in observers:
            observer.observe(time, outputs, iterations)
