"""The observers that record a coupled run."""

import csv
import io
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from models.core.quantities import Quantity, Vector

from ..engine.coupling import Coupling
from ..engine.observer import Observer, is_recorded
from ..engine.step import REASONS, Step
from ..participants.protocol import SideChannel
from ..participants.third_party import ThirdPartyComponent
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

# In nominal sizes, of which many an FMU declares none.
LARGEST = 1e30


class ResultRecorder(Observer):
    """Records the outputs in `quantities` of every n-th macro step and at `stop` (s), and each step's effort,
    in the journals of `folder` that become the groups /coupled and /steps of the result. Rows are in memory
    for `held_for` (s) at most.

    `senseless` has, by output, the first recorded time (s) at which it was not finite, or above LARGEST times
    its nominal size: FMUs that diverge report success. NaN in what is
    connected ends a run at once (`coupling`); what is only recorded is told at the end.
    """

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
        self.senseless: dict[str, float] = {}

    def begin(self, names: Sequence[str]) -> None:
        self._open(names, None, None)

    def _open(self, names: Sequence[str], coupled: Mark | None, steps: Mark | None) -> None:
        self._kept = np.array([i for i, name in enumerate(names) if name in self._quantities], dtype=int)
        self._number = {int(kept): i for i, kept in enumerate(self._kept)}
        variables = {names[i]: self._quantities[names[i]] for i in self._kept}
        self._names = list(variables)
        sizes = np.array([quantity.nominal for quantity in variables.values()])
        self._largest = np.minimum(LARGEST * sizes, np.finfo(np.float64).max)
        self._coupled = Journal(self._folder / f"coupled{SUFFIX}", variables, coupled, self._held_for)
        # With the names, so that a journal alone says which variable a number is.
        quantities = STEP_VARIABLES | {"source": replace(STEP_VARIABLES["source"], choices=tuple(variables))}
        try:
            self._steps = Journal(self._folder / f"steps{SUFFIX}", quantities, steps, self._held_for)
        except BaseException:
            self._coupled.close()
            raise

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if is_recorded(self._count, time, self._every, self._stop):
            values = outputs()[self._kept]
            self._coupled.append(time, values)
            for i in np.flatnonzero(~(np.abs(values) <= self._largest)):
                self.senseless.setdefault(self._names[i], time)
        if self._count:
            self._step[:] = (
                step.length, step.iterations, step.rejected, step.error, self._number.get(step.source, -1),
                step.reason, step.parts,
            )  # fmt: skip
            self._steps.append(time, self._step)
        self._count += 1
        # Both at once: of a process that is killed, the groups end together.
        if self._coupled.due or self._steps.due:
            self._coupled.flush()
            self._steps.flush()

    def state(self) -> dict[str, Plain]:
        marks = {"coupled": self._coupled.mark(), "steps": self._steps.mark()}
        return {"count": self._count, "senseless": dict(self.senseless), **marks}

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        self._count, self.senseless = state["count"], dict(state["senseless"])
        self._open(names, state["coupled"], state["steps"])

    def end(self, complete: bool, message: str) -> None:
        try:
            self._coupled.close()
        finally:
            self._steps.close()


FORMULA = ("=", "+", "-", "@", "\t", "\r")
HEADER = ("time", "variable", "text")


def list_texts(components: Mapping[str, ThirdPartyComponent]) -> dict[str, list[str]]:
    """The outputs that are strings or binary values, by instance."""
    found = {
        name: component.about.list_texts("output")
        for name, component in components.items()
        if not component.about.integrated
    }
    return {name: texts for name, texts in found.items() if texts}


class TextRecorder(Observer):
    """Records the `texts` (by instance) in a CSV file: at the start, and where a macro step changes one.

    A text holds until the next line of its variable. Binary values are hexadecimal digits. A text that
    spreadsheets would take for a formula gets a ' in front.
    """

    def __init__(self, path: Path, texts: Mapping[str, Sequence[str]]) -> None:
        self._path, self._texts = path, texts
        self._sides: dict[str, SideChannel] = {}
        self._last: dict[str, str] = {}

    def watch(self, coupling: Coupling) -> None:
        units = dict(zip(coupling.wiring.names, coupling.participants, strict=True))
        for name in self._texts:
            side = units[name].abilities.side
            assert side is not None  # it has texts
            self._sides[name] = side

    def begin(self, names: Sequence[str]) -> None:
        self._file: Any = self._path.open("wb")
        self._write([HEADER])

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        rows = []
        for instance, names in self._texts.items():
            for name, text in zip(names, self._sides[instance].get_texts(names), strict=True):
                if self._last.get(variable := f"{instance}.{name}") != text:
                    self._last[variable] = text
                    # Spreadsheets would compute a text that begins so, or run its command.
                    shown = f"'{text}" if text.startswith(FORMULA) else text
                    rows.append((repr(float(time)), variable, shown))
        if rows:
            self._write(rows)

    def end(self, complete: bool, message: str) -> None:
        self._file.close()

    def state(self) -> dict[str, Plain]:
        return {"size": self._file.tell(), "last": dict(self._last)}

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        self._file = self._path.open("r+b")
        self._file.truncate(state["size"])
        self._file.seek(state["size"])
        self._last = dict(state["last"])

    def _write(self, rows: Sequence[Sequence[str]]) -> None:
        lines = io.StringIO()
        csv.writer(lines, lineterminator="\n").writerows(rows)
        self._file.write(lines.getvalue().encode())
        self._file.flush()
