"""What compiled code needs to make the calls of a participant (see `compiled`). Nothing is compiled here."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from models.core.quantities import Vector

# Addresses of the functions, of the component, and of the references and numbers that are given to it and
# taken from it; how many these are. The interpreter is released for the calls unless the FMU is in Python.
# An FMU of FMI 3 writes what its step came to into `outcome`: event, end, early return (a byte each), at 8
# the time. `warned` counts the calls that return a warning.
CALLS = np.dtype(
    [
        (name, np.int64)
        for name in (
            "component", "in_python", "fmi3", "outcome", "set_real", "do_step", "get_real",
            "given", "given_references", "given_count",
            "taken", "taken_references", "taken_count", "warned",
        )
    ]
)  # fmt: skip

# Why a component in this process has no calls of an FMU.
IN_PROCESS = "it is no FMU"


class NotCompiledError(Exception):
    """Why compiled code cannot make a participant's calls itself."""


# Which call of an FMU did not succeed.
FINE, SET, STEP, GET, NOT_FINITE = range(5)


@dataclass(frozen=True)
class CompiledCalls:
    """The calls of a macro step that a participant offers to compiled code; wrappers change their part.

    The FMU is given `factors` times the bound inputs at `picked` (rows, columns) plus `offsets`, and returns
    its outputs, then the rates of the outputs `rated`. Those of `picked` that are `held` get the mean over
    the step; `ends`: after the step all get the value at its end.
    `describe(record)` fills in addresses. `fail(call, status, time, step)` raises the error of a call; it
    returns if the step was made after all. `references(names)` are those of outputs that compiled code can
    read, or None.
    """

    picked: tuple[Any, Any]
    held: Any
    ends: bool
    factors: Vector
    offsets: Vector
    given: Any
    taken: Any
    rated: Any
    describe: Callable[[Any], None]
    fail: Callable[[int, int, float, float], None]
    check_end: Callable[[float, float], None]
    references: Callable[[Sequence[str]], Any]

    def bind(self, record: Any, given: Vector, taken: Vector) -> None:
        """Fill the record; the numbers given and taken begin in these vectors."""
        self.describe(record)
        record["given"], record["taken"] = given.ctypes.data, taken.ctypes.data
        for name, references in (("given", self.given), ("taken", self.taken)):
            record[f"{name}_references"] = references.ctypes.data
            record[f"{name}_count"] = len(references)

    def bind_reading(self, names: Sequence[str], memory: Vector) -> tuple[Any, Any] | None:
        """A record with which `take` reads these outputs into `memory`, and the references to be kept."""
        references = self.references(names)
        if references is None:
            return None
        record = np.zeros(1, dtype=CALLS)
        self.describe(record[0])
        record["taken"], record["taken_count"] = memory.ctypes.data, len(memory)
        record["taken_references"] = references.ctypes.data
        return record, references
