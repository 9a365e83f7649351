"""What a tool is asked to do with an FMU, and what it answers.

Tools run this in environments of their own: nothing but the standard library is imported here.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

# The environment variable that names the tool's own folder.
FOLDER = "TRIBOCOSIM_TOOL"


@dataclass(frozen=True)
class Case:
    """An FMU, steps of equal size from t = 0, and the inputs' values that are held in each.

    inputs, outputs: names of variables of type Real (FMI 3: Float64); references: their value references.
    table: a row of input values for every step. identifier and token: those of modelDescription.xml.
    python: it runs in Python.
    """

    fmu: str
    fmi: int
    python: bool
    identifier: str
    token: str
    step: float
    inputs: Sequence[str]
    outputs: Sequence[str]
    references: Mapping[str, int]
    table: Sequence[Sequence[float]]

    @property
    def steps(self) -> int:
        return len(self.table)

    @property
    def start(self) -> dict[str, float]:
        """Values of the inputs in the first step."""
        return dict(zip(self.inputs, self.table[0], strict=True))

    def references_of(self, names: Sequence[str]) -> list[int]:
        return [self.references[name] for name in names]

    def rows(self) -> list[dict[str, float]]:
        """Values of the inputs, step by step."""
        return [dict(zip(self.inputs, row, strict=True)) for row in self.table]

    def written(self, file: Path) -> Path:
        file.write_text(json.dumps(asdict(self)))
        return file

    @staticmethod
    def read(file: Path) -> Case:
        return Case(**json.loads(file.read_text()))


class RefusedError(Exception):
    """The tool said that it cannot go on; the message is the tool's."""


class NotTriedError(Exception):
    """There is nothing here to try it with; the message says what is missing."""


def loaded() -> None:
    """The tool has taken the FMU, and has an instance of it."""
    print("LOADED", flush=True)


def equal_steps(count: int, step: float) -> list[tuple[float, float]]:
    """Time and size of steps that begin at multiples of their size."""
    return [(i * step, step) for i in range(count)]
