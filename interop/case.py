"""What a tool does with an FMU.

Tools import this file in their own environments, so it imports the standard library only.
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
    """An FMU, steps of equal size from t = 0, and the input values that each step holds.

    inputs, outputs: names of variables of type Real (FMI 3: Float64); references: their value references.
    table: a row of input values for each step. identifier, token: from modelDescription.xml.
    python: the FMU runs in Python.
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

    def find_references(self, names: Sequence[str]) -> list[int]:
        return [self.references[name] for name in names]

    def rows(self) -> list[dict[str, float]]:
        """Values of the inputs, step by step."""
        return [dict(zip(self.inputs, row, strict=True)) for row in self.table]

    def write(self, file: Path) -> Path:
        file.write_text(json.dumps(asdict(self)))
        return file

    @staticmethod
    def read(file: Path) -> Case:
        return Case(**json.loads(file.read_text()))


class RefusedError(Exception):
    """The tool refused to go on; the message is the tool's."""


class NotTriedError(Exception):
    """The case cannot be tried on this machine; the message says what is missing."""


def report_loaded() -> None:
    """Report that the tool has an instance of the FMU."""
    print("LOADED", flush=True)


def list_equal_steps(count: int, step: float) -> list[tuple[float, float]]:
    """Time and size of each step; steps begin at multiples of their size."""
    return [(i * step, step) for i in range(count)]
