"""Which variables of a component are elements of one array in FMI 3.0.

Vectors of a component's records are arrays, and with them their start values, derivatives by time and states.
Those whose elements are connected each to another participant stay scalars, which every tool can connect; a
component's folder names their structural sizes in `PORTS`.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby

from .memory import Variable


@dataclass(frozen=True)
class Shaped:
    """A variable of FMI 3.0: a scalar, or an array of one dimension with its elements; alike but for their
    names, references and start values."""

    name: str
    elements: tuple[Variable, ...]
    array: bool

    @property
    def first(self) -> Variable:
        """The scalar, or the element whose reference is that of the array."""
        return self.elements[0]


def shaped(model_name: str, variables: Iterable[Variable]) -> list[Shaped]:
    """The variables of FMI 3.0, in the same order."""
    ports = getattr(importlib.import_module(f"fmus.{model_name}"), "PORTS", ())
    found = []
    for (name, array), elements in groupby(variables, lambda v: _array_of(v, ports)):
        found.append(Shaped(name, tuple(elements), array))
    return found


def _array_of(variable: Variable, ports: Iterable[str]) -> tuple[str, bool]:
    """The name of the array and whether it is one."""
    if not variable.size or variable.size in ports:
        return variable.name, False
    return re.sub(r"\[\d+\]", "", variable.name), True
