"""Macro steps of one length."""

import math
from bisect import bisect_right
from typing import Any

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.step import EVENT, FIXED, STOP, TIME_EVENT, Step
from ..errors import EndedError
from ..masters import Master
from .guard import RunawayGuard
from .locator import Locator

# Share of a step by which two instants may differ and be one.
SAME = 1e-9


class FixedSteps:
    """Steps that end at multiples of `macro_step`, at `stop`, and at known events of FMUs.

    With `event_tolerance` (s) they end at located events, too.
    """

    def __init__(self, macro_step: float, event_tolerance: float | None = None) -> None:
        self.macro_step = macro_step
        self._event_tolerance = event_tolerance
        self._locator: Locator | None = None

    @property
    def locates(self) -> bool:
        """Whether it looks for events."""
        return self._event_tolerance is not None

    def begin(self, coupling: Coupling, master: Master, start: float, stop: float) -> None:
        """Before the first step."""
        self._coupling, self._master = coupling, master
        self._start, self._stop = start, stop
        self._guard = RunawayGuard(coupling, master)
        if self._event_tolerance is not None:
            self._locator = Locator(coupling, self._event_tolerance)

    def step(self, time: float) -> Step:
        """The next step from `time`, accepted into the coupling; RunError where none can be made."""
        end, reason = self._end(time)
        if self._locator is not None:
            return self._locate_step(time, end, reason, self._locator)
        iterations = self._master.step(self._coupling, time, end - time).iterations
        return self._accept(Step(end, end - time, iterations, reason=reason))

    def _end(self, time: float) -> tuple[float, int]:
        """Where the next step ends, and why: at a known event, or a multiple of the step."""
        end, reason = self._find_end(time)
        event = self._coupling.instants.next_event(time)
        return (event, TIME_EVENT) if event < end - SAME * self.macro_step else (end, reason)

    def _find_end(self, time: float) -> tuple[float, int]:
        """Times are multiples of the step: a sum of steps would drift."""
        made = (time - self._start) / self.macro_step
        # Of very many steps rounding is the larger.
        slack = SAME + 4.0 * math.ulp(made)
        n = math.floor(made + slack) + 1
        end = self._start + n * self.macro_step
        last = self._start + (n + slack) * self.macro_step >= self._stop
        if not last:
            return end, FIXED
        # What ends as any other step does isn't cut short.
        return self._stop, FIXED if abs(end - self._stop) <= 1e-6 * self.macro_step else STOP

    def _locate_step(self, time: float, end: float, reason: int, locator: Locator) -> Step:
        coupling, gap = self._coupling, 0.0
        ahead = locator.ahead(time)
        if ahead < end - locator.tolerance:
            end, reason = ahead, TIME_EVENT
            gap = min(locator.tolerance, 0.5 * (end - time))
        whole = end - time - gap
        iterations = 0

        coupling.state.history.end_smooth[:] = ~locator.bent(end)
        with coupling.points.keep() as saved:

            def attempt(length: float) -> None:
                nonlocal iterations
                coupling.points.restore(saved)
                iterations = self._master.step(coupling, time, length).iterations

            try:
                attempt(whole)
            except EndedError as error:
                if not error.inside(time):
                    raise
                end, reason, gap, whole = error.reached, STOP, 0.0, error.reached - time
                attempt(whole)
            length, over, source = locator.locate(saved, time, whole, attempt)
            if length == 0.0:
                coupling.points.restore(saved)
        if length < whole:
            gap, end, reason = over, time + length + over, EVENT
        smooth: Any = False
        if gap:
            smooth = ~locator.bent(end, source)
            if length:
                coupling.accept(time + length)
            before = saved.coupling.values if reason == EVENT else None
            gap = locator.cross(self._master, time + length, gap, before)
        if source >= 0:
            end = locator.last = time + length + gap
        number = coupling.wiring.output_number(source)
        made = self._accept(Step(end, end - time, iterations, source=number, reason=reason))
        if gap or locator.due(end):
            coupling.state.history.restart(smooth)
        return made

    def _accept(self, step: Step) -> Step:
        self._guard.judge(step.end, step.length)
        self._coupling.accept(step.end)
        return step

    def state(self) -> dict[str, Any]:
        """All that decides the coming steps, as plain numbers."""
        return self._guard.state() | ({"last": self._locator.last} if self._locator else {})

    def resume(self, state: dict[str, Any]) -> None:
        """After `begin`: go on as from that state."""
        self._guard.resume(state)
        if self._locator:
            self._locator.last = float(state["last"])


# After a step that is this small a share of the one ahead, signals have no past to go on from: of so small a
# difference the error is the larger part, and going on over so long a step multiplies it.
TOO_SHORT = 1e-3


class RefinedSteps(FixedSteps):
    """The steps from the first to the last of `ends`, each divided into equal `parts`.

    Like every given sequence that is divided, they keep the order of an error: it falls with the power p of
    1 / parts. Ends of the other run are met to the bit. With `event_tolerance` (s) events are located anew:
    they come at other instants where the error is smaller.
    """

    def __init__(self, ends: Vector, parts: int, event_tolerance: float | None = None) -> None:
        super().__init__(float(ends[-1] - ends[0]) / (len(ends) - 1) / parts, event_tolerance)
        self._ends, self._parts = [float(end) for end in ends], parts

    def _find_end(self, time: float) -> tuple[float, int]:
        n = min(bisect_right(self._ends, time), len(self._ends) - 1)
        reached = self._divide(n, time)
        if reached - time <= SAME * (reached - self._ends[n - 1]) and n < len(self._ends) - 1:
            reached = self._divide(n + 1, time)  # an event has come just before this end
        return reached, STOP if reached >= self._stop else FIXED

    def _divide(self, n: int, time: float) -> float:
        """The first end of a part of the step to ends[n] that is not at `time`."""
        begin, end = self._ends[n - 1 : n + 1]
        inner = (begin + k * (end - begin) / self._parts for k in range(1, self._parts))
        slack = SAME * (end - begin)
        return next((reached for reached in inner if reached > time + slack), end)

    def _accept(self, step: Step) -> Step:
        made = super()._accept(step)
        if made.end < self._stop and made.length < TOO_SHORT * (self._find_end(made.end)[0] - made.end):
            self._coupling.state.history.restart()
        return made
