"""An observer that keeps everything in memory."""

from collections.abc import Callable, Sequence

import numpy as np

from models.core.quantities import Vector
from orchestrator.engine.observer import Observer
from orchestrator.engine.step import Step


class Recorder(Observer):
    def begin(self, names: Sequence[str]) -> None:
        self.names = list(names)
        self._times: list[float] = []
        self._rows: list[Vector] = []
        self.iterations: list[int] = []
        self.steps: list[Step] = []
        self.ended: tuple[bool, str] | None = None

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        self._times.append(time)
        self._rows.append(outputs().copy())
        self.iterations.append(step.iterations)
        self.steps.append(step)

    def end(self, complete: bool, message: str) -> None:
        self.ended = (complete, message)

    @property
    def times(self) -> Vector:
        return np.array(self._times)

    @property
    def rows(self) -> Vector:
        """All outputs after every step."""
        return np.array(self._rows)

    def __getitem__(self, name: str) -> Vector:
        return self.rows[:, self.names.index(name)]
