"""Macro steps that are parts of those of another run."""

from bisect import bisect_right

from models.core.quantities import Vector

from ..engine.step import FIXED, STOP, Step
from .fixed import SAME, FixedSteps

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
