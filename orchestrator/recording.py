"""Observers that record a run: into the result file, and as CSV in the FMI cross-check layout."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from models.quantities import Quantity, Vector

from .results import ResultFile, Series

STEP_VARIABLES = {
    "macro_step": Quantity("s", "length of the macro step that ended here"),
    "iterations": Quantity("1", "iterations of the macro step that ended here", count=True),
}


class ResultRecorder:
    """Records all outputs of every n-th macro step in /coupled, every step's effort in /steps."""

    def __init__(self, file: ResultFile, quantities: Mapping[str, Quantity], every: int) -> None:
        self._file = file
        self._quantities = quantities
        self._every = every
        self._count = 0
        self._last = 0.0
        self._step = np.zeros(2)
        self._coupled: Series | None = None

    def begin(self, names: Sequence[str]) -> None:
        self._coupled = self._file.series("coupled", {name: self._quantities[name] for name in names})
        self._steps = self._file.series("steps", STEP_VARIABLES)

    def observe(self, time: float, outputs: Callable[[], Vector], iterations: int) -> None:
        assert self._coupled
        if self._count % self._every == 0:
            self._coupled.append(time, outputs())
        if self._count:
            self._step[0] = time - self._last
            self._step[1] = iterations
            self._steps.append(time, self._step)
        self._count += 1
        self._last = time

    def end(self, complete: bool, message: str) -> None:
        if self._coupled:
            self._coupled.flush()
            self._steps.flush()


class CsvRecorder:
    """Writes "time","instance.variable",... in SI units, every n-th macro step."""

    def __init__(self, path: Path, every: int) -> None:
        self._path = path
        self._every = every
        self._count = itertools.count()

    def begin(self, names: Sequence[str]) -> None:
        self._file = self._path.open("w", encoding="ascii", buffering=1 << 20)
        self._file.write(",".join(f'"{name}"' for name in ("time", *names)) + "\n")

    def observe(self, time: float, outputs: Callable[[], Vector], iterations: int) -> None:
        if next(self._count) % self._every == 0:
            # repr: the shortest text that reads back as the same number.
            self._file.write(",".join(map(repr, (time, *outputs().tolist()))) + "\n")

    def end(self, complete: bool, message: str) -> None:
        self._file.close()
