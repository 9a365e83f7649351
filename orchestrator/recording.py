"""Observers that record a run: into the result file, and as CSV in the FMI cross-check layout."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from models.quantities import Quantity, Vector

from .journal import FLUSH_SECONDS, START_OVER, SUFFIX, Journal, JournalError
from .plain_data import Plain
from .stepping import REASONS, Step

STEP_VARIABLES = {
    "macro_step": Quantity("s", "length of the macro step that ended here"),
    "iterations": Quantity("1", "iterations of the macro step that ended here", count=True),
    "rejected": Quantity("1", "attempts rejected before the macro step that ended here", count=True),
    "error": Quantity("1", "estimated error of the macro step that ended here, over what is allowed"),
    "source": Quantity(
        "1", "variable with most of the error, by its number among flag_meanings; -1: none", count=True
    ),
    "reason": Quantity("1", "what set the length of the macro step that ended here", choices=REASONS),
}


class ResultRecorder:
    """Records all outputs of every n-th macro step and every step's effort, in the journals of `folder`
    that become the groups /coupled and /steps of the result. Rows are in memory for `held_for` (s) at
    most."""

    def __init__(
        self,
        folder: Path,
        quantities: Mapping[str, Quantity],
        every: int,
        held_for: float = FLUSH_SECONDS,
    ) -> None:
        self._folder = folder
        self._quantities = quantities
        self._every = every
        self._held_for = held_for
        self._count = 0
        self._step = np.zeros(len(STEP_VARIABLES))

    def begin(self, names: Sequence[str]) -> None:
        self._open(names, None, None)

    def _open(self, names: Sequence[str], coupled: int | None, steps: int | None) -> None:
        variables = {name: self._quantities[name] for name in names}
        self._coupled = Journal(self._folder / f"coupled{SUFFIX}", variables, coupled, self._held_for)
        # With the names, so that a journal alone says which variable a number is.
        told = STEP_VARIABLES | {"source": replace(STEP_VARIABLES["source"], choices=tuple(names))}
        try:
            self._steps = Journal(self._folder / f"steps{SUFFIX}", told, steps, self._held_for)
        except BaseException:
            self._coupled.close()
            raise

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if self._count % self._every == 0:
            self._coupled.append(time, outputs())
        if self._count:
            self._step[:] = (
                step.length,
                step.iterations,
                step.rejected,
                step.error,
                step.source,
                step.reason,
            )
            self._steps.append(time, self._step)
        self._count += 1

    def state(self) -> dict[str, Plain]:
        self._coupled.sync()
        self._steps.sync()
        return {
            "count": self._count,
            "coupled": self._coupled.rows,
            "steps": self._steps.rows,
        }

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        self._count = state["count"]
        self._open(names, state["coupled"], state["steps"])

    def end(self, complete: bool, message: str) -> None:
        self._coupled.close()
        self._steps.close()


class CsvRecorder:
    """Writes "time","instance.variable",... in SI units, every n-th macro step; with `at_once` every line is
    in the file when its step is over."""

    def __init__(self, path: Path, every: int, at_once: bool = False) -> None:
        self._path = path
        self._every = every
        self._buffering = 1 if at_once else 1 << 20
        self._count = 0

    def begin(self, names: Sequence[str]) -> None:
        self._file = self._path.open("w", encoding="utf-8", newline="\n", buffering=self._buffering)
        quoted = (name.replace('"', '""') for name in ("time", *names))
        self._file.write(",".join(f'"{name}"' for name in quoted) + "\n")

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if self._count % self._every == 0:
            # repr: the shortest text that reads back as the same number.
            self._file.write(",".join(map(repr, (time, *outputs().tolist()))) + "\n")
        self._count += 1

    def state(self) -> dict[str, Plain]:
        self._file.flush()
        os.fsync(self._file.fileno())
        return {"count": self._count, "bytes": self._file.tell()}

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        size = self._path.stat().st_size if self._path.exists() else 0
        if size < state["bytes"]:
            raise JournalError(
                f"{self._path}: has {size} bytes, of {state['bytes']} at the checkpoint; {START_OVER}"
            )
        self._count = state["count"]
        os.truncate(self._path, state["bytes"])
        self._file = self._path.open("a", encoding="utf-8", newline="\n", buffering=self._buffering)

    def end(self, complete: bool, message: str) -> None:
        self._file.close()
