"""Outputs that were not finite in a run: no numbers (NaN), or infinite.

NaN in what is connected ends a run at once (`coupling`); what is only recorded does not, and is told at the
end.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from models.core.quantities import Vector

from ..engine.observer import is_recorded
from ..engine.step import Step
from ..store.json_codec import Plain


class NotFinite:
    """Observer of every n-th macro step and of `stop` (s): `since` has, by output, the first time (s) at
    which it was not finite."""

    def __init__(self, every: int, stop: float) -> None:
        self._every, self._stop = every, stop
        self._count = 0
        self.since: dict[str, float] = {}

    def begin(self, names: Sequence[str]) -> None:
        self._names = list(names)

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if is_recorded(self._count, time, self._every, self._stop):
            bad = ~np.isfinite(outputs())
            if bad.any():
                for i in np.flatnonzero(bad):
                    self.since.setdefault(self._names[i], time)
        self._count += 1

    def state(self) -> dict[str, Plain]:
        return {"count": self._count, "since": dict(self.since)}

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        self.begin(names)
        self._count, self.since = state["count"], dict(state["since"])

    def end(self, complete: bool, message: str) -> None:
        pass
