"""What single participants take of a run: time, and numbers of calls."""

from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from statistics import median
from time import perf_counter
from typing import Any


@contextmanager
def timed(spent: Any, key: Any) -> Iterator[None]:
    """Add the wall time (s) of the block to `spent[key]`."""
    begin = perf_counter()
    try:
        yield
    finally:
        spent[key] += perf_counter() - begin


class Effort:
    """Wall time (s) by the number of a participant: of its initialisation, of its steps with what they are
    given and what is read, and of saving and restoring its state; how often it was taken back to one; the
    steps of its own (`substeps`, `retries`) within macro steps, and those of them that failed.

    Where compiled code makes the steps, and of savings, some are timed, and stand for those between (see
    `Sampled`).
    """

    def __init__(self, size: int) -> None:
        self.initialising, self.stepping, self.saving = ([0.0] * size for _ in range(3))
        self.restored, self.own_steps, self.failed = ([0] * size for _ in range(3))

    def count(self, i: int, failed: bool) -> None:
        """Participant i has tried a step of its own."""
        self.own_steps[i] += 1
        self.failed[i] += failed

    def state(self) -> dict[str, Any]:
        return {name: list(values) for name, values in vars(self).items()}

    def resume(self, state: Mapping[str, Any]) -> None:
        for name, values in vars(self).items():
            values[:] = state[name]


class Sampled:
    """The wall time (s) of calls of which few are timed: the others have the median of the last three.

    So a timed call that waits for the processor counts once.
    """

    def __init__(self) -> None:
        self._last: deque[float] = deque(maxlen=3)

    def count(self, seconds: float, calls: int) -> float:
        """The time of `calls` calls, of which the last was timed."""
        self._last.append(seconds)
        return seconds + (calls - 1) * median(self._last)


@dataclass(frozen=True)
class Spent:
    """What one participant took of a run, see `Effort`; `opening_s` has its library and process started."""

    do_steps: int
    restored: int
    opening_s: float
    initialising_s: float
    stepping_s: float
    saving_s: float
    closing_s: float = 0.0
    own_steps: int = 0
    failed: int = 0
