"""The macro steps of a run, from its result or from the journals of one that was killed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from models.core.quantities import Vector

from ...errors import MistakeError
from ...store.journal import Recorded, journals
from ...store.output_folder import RESULT, find_remedy, find_run_state, refuse_missing
from ...store.records import Group, open_records
from ...store.result_file import ResultFile

# Columns of /steps, and what a value of each needs: there may be many millions of steps.
COLUMNS = {
    "time": np.float64,
    "macro_step": np.float64,
    "iterations": np.int32,
    "rejected": np.int32,
    "error": np.float32,
    "source": np.int32,
    "reason": np.int8,
    "parts": np.int8,
}
BLOCK = 65_536  # rows of a journal read at once


@dataclass(frozen=True)
class Steps:
    """Macro steps in order, an entry for each (see `stepping.Step`); `outputs` are what `source` numbers.

    `end` and `length` in s.
    """

    end: Vector
    length: Vector
    iterations: Any
    rejected: Any
    error: Any
    source: Any
    reason: Any
    parts: Any
    outputs: tuple[str, ...] = ()

    @classmethod
    def of(cls, columns: Mapping[str, Any], outputs: tuple[str, ...]) -> Steps:
        """Of the columns of /steps."""
        values: list[Any] = [np.asarray(columns[name], kind) for name, kind in COLUMNS.items()]
        return replace(cls(*values), outputs=outputs)

    def __len__(self) -> int:
        return len(self.end)

    @property
    def start(self) -> Vector:
        """When each step began (s)."""
        return self.end - self.length

    @property
    def inner_ends(self) -> Vector:
        """The start, and where all parts of all steps ended (s), in order."""
        halved = self.parts == 2
        middle = self.start[halved] + 0.5 * self.length[halved]
        return np.union1d(np.append(self.start[:1], self.end), middle)

    @property
    def work(self) -> Vector:
        """Sweeps that each step took. Of rejected attempts the number is known: each counts as the last."""
        return np.asarray(self.iterations * (1.0 + self.rejected))

    def name(self, source: int) -> str:
        """The output of that number."""
        return self.outputs[source] if 0 <= source < len(self.outputs) else f"output {source}"


NONE = Steps.of({name: [] for name in COLUMNS}, ())


def read_written_steps(result: ResultFile) -> Steps:
    """The steps of a result being written."""
    if not result.has("steps"):
        return NONE
    columns = _columns(lambda name: result.read("steps", [name], slice(None))[name])
    return Steps.of(columns, result.quantities("steps")["source"].choices)


def read_steps(out: Path) -> tuple[Steps, str]:
    """The steps of the run in an output folder, and how it ended. MistakeError if there are none."""
    if (out / RESULT).is_file():
        return _read_file(out)
    refuse_missing(out)
    found = journals(find_run_state(out)) if find_run_state(out).is_dir() else {}
    if "steps" not in found:
        remedy = find_remedy(out, "give a run's output folder")
        raise MistakeError(f"{out}: holds no result and no unfinished run; {remedy}")
    return _read_journal(found["steps"]), "incomplete: the run goes on, or was killed"


def read_group(group: Group | None) -> Steps:
    """The steps of a result's group."""
    if group is None:
        return NONE
    return Steps.of(_columns(group.read), tuple(group.attribute("source", "flag_meanings").split()))


def _read_file(out: Path) -> tuple[Steps, str]:
    try:
        with open_records(out) as records:
            return read_group(records.groups.get("steps")), str(records.attributes.get("message", ""))
    except (OSError, KeyError) as error:
        raise MistakeError(f"{out / RESULT}: is no result of this version ({error}); run it again") from None


def _read_journal(path: Path) -> Steps:
    journal = Recorded(path)
    places = {name: i for i, name in enumerate(journal.columns)}
    if missing := [name for name in COLUMNS if name not in places]:
        raise MistakeError(f"{path}: lacks {', '.join(missing)}: is of another version; run it again")
    parts: dict[str, list[Any]] = {name: [np.zeros(0, kind)] for name, kind in COLUMNS.items()}
    for block in journal.blocks(BLOCK):
        for name, kind in COLUMNS.items():
            parts[name].append(block[:, places[name]].astype(kind))
    columns = {name: np.concatenate(part) for name, part in parts.items()}
    return Steps.of(columns, journal.columns["source"].choices)


def _columns(read: Callable[[str], Any]) -> dict[str, Any]:
    """One column after the other, each as small as it can be."""
    return {name: np.asarray(read(name)).astype(kind) for name, kind in COLUMNS.items()}
