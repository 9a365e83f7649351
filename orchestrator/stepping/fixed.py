"""Macro steps of one length."""

from __future__ import annotations

import math
from typing import Any

from ..exchange import Exchange
from ..masters import Master
from .guard import RunawayGuard
from .locator import Locator
from .protocol import EVENT, FIXED, STOP, TIME_EVENT, Step


class FixedSteps:
    """Steps that end at multiples of `macro_step`, at `stop`, and, with `event_tolerance`, at events."""

    def __init__(self, macro_step: float, event_tolerance: float | None = None) -> None:
        self.macro_step = macro_step
        self._event_tolerance = event_tolerance
        self._locator: Locator | None = None

    @property
    def locates(self) -> bool:
        return self._event_tolerance is not None

    def begin(self, exchange: Exchange, master: Master, start: float, stop: float) -> None:
        self._exchange, self._master = exchange, master
        self._start, self._stop = start, stop
        self._guard = RunawayGuard(exchange, master)
        if self._event_tolerance is not None:
            self._locator = Locator(exchange, self._event_tolerance)

    def step(self, time: float) -> Step:
        end, reason = self._end(time)
        if self._locator is not None:
            return self._located(time, end, reason, self._locator)
        iterations = self._master.step(self._exchange, time, end - time)
        return self._accepted(Step(end, end - time, iterations, reason=reason))

    def _end(self, time: float) -> tuple[float, int]:
        """Times are multiples of the step: a sum of steps would drift."""
        n = math.floor((time - self._start) / self.macro_step + 1e-9) + 1
        end = self._start + n * self.macro_step
        last = self._start + (n + 1e-9) * self.macro_step >= self._stop
        return (self._stop, STOP) if last else (end, FIXED)

    def _located(self, time: float, end: float, reason: int, locator: Locator) -> Step:
        exchange = self._exchange
        ahead = locator.ahead(time)
        if ahead < end - locator.tolerance:
            end, reason = ahead, TIME_EVENT
        iterations = 0

        with exchange.point() as saved:

            def attempt(length: float) -> None:
                nonlocal iterations
                exchange.restore(saved)
                exchange.history.end_smooth = reason != TIME_EVENT and length == end - time
                iterations = self._master.step(exchange, time, length)

            attempt(end - time)
            length, source = locator.locate(saved, time, end - time, attempt)
        if source >= 0 or length < end - time:
            end, reason = time + length, EVENT
        told = exchange.output_number(source)
        made = self._accepted(Step(end, length, iterations, source=told, reason=reason))
        if source >= 0 or reason == TIME_EVENT or locator.due(end):
            exchange.history.restart()
        return made

    def _accepted(self, step: Step) -> Step:
        self._guard.judge(step.end, step.length)
        self._exchange.accept(step.end)
        return step

    def state(self) -> dict[str, Any]:
        return self._guard.state() | ({"last": self._locator.last} if self._locator else {})

    def resume(self, state: dict[str, Any]) -> None:
        self._guard.resume(state)
        if self._locator:
            self._locator.last = float(state["last"])
