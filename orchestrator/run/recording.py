"""The observer that records a run, in journals of which result and CSV are made."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from models.core.quantities import Quantity, Vector

from ..engine.observer import is_recorded
from ..engine.step import REASONS, Step
from ..store.journal import FLUSH_SECONDS, SUFFIX, Journal, Mark
from ..store.json_codec import Plain

STEP_VARIABLES = {
    "macro_step": Quantity("s", "length of the macro step that ended here"),
    "iterations": Quantity("1", "iterations of the macro step that ended here", count=True),
    "rejected": Quantity("1", "attempts rejected before the macro step that ended here", count=True),
    "error": Quantity("1", "estimated error of the macro step that ended here, over what is allowed"),
    "source": Quantity(
        "1", "variable with most of the error, by its number among flag_meanings; -1: none", count=True
    ),
    "reason": Quantity("1", "what set the length of the macro step that ended here", choices=REASONS),
    "parts": Quantity("1", "equal parts in which the macro step that ended here was made", count=True),
}


class ResultRecorder:
    """Records all outputs of every n-th macro step and at `stop` (s), and every step's effort, in the
    journals of `folder` that become the groups /coupled and /steps of the result. Rows are in memory for
    `held_for` (s) at most."""

    def __init__(
        self,
        folder: Path,
        quantities: Mapping[str, Quantity],
        every: int,
        held_for: float = FLUSH_SECONDS,
        stop: float = math.inf,
    ) -> None:
        self._folder = folder
        self._quantities = quantities
        self._every, self._stop = every, stop
        self._held_for = held_for
        self._count = 0
        self._step = np.zeros(len(STEP_VARIABLES))

    def begin(self, names: Sequence[str]) -> None:
        self._open(names, None, None)

    def _open(self, names: Sequence[str], coupled: Mark | None, steps: Mark | None) -> None:
        variables = {name: self._quantities[name] for name in names}
        self._coupled = Journal(self._folder / f"coupled{SUFFIX}", variables, coupled, self._held_for)
        # With the names, so that a journal alone says which variable a number is.
        quantities = STEP_VARIABLES | {"source": replace(STEP_VARIABLES["source"], choices=tuple(names))}
        try:
            self._steps = Journal(self._folder / f"steps{SUFFIX}", quantities, steps, self._held_for)
        except BaseException:
            self._coupled.close()
            raise

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if is_recorded(self._count, time, self._every, self._stop):
            self._coupled.append(time, outputs())
        if self._count:
            self._step[:] = (
                step.length, step.iterations, step.rejected, step.error, step.source, step.reason, step.parts,
            )  # fmt: skip
            self._steps.append(time, self._step)
        self._count += 1
        # Both at once: of a process that is killed, the groups end together.
        if self._coupled.due or self._steps.due:
            self._coupled.flush()
            self._steps.flush()

    def state(self) -> dict[str, Plain]:
        return {"count": self._count, "coupled": self._coupled.mark(), "steps": self._steps.mark()}

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        self._count = state["count"]
        self._open(names, state["coupled"], state["steps"])

    def end(self, complete: bool, message: str) -> None:
        try:
            self._coupled.close()
        finally:
            self._steps.close()
