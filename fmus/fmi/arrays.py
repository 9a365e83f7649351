"""Which variables of a component are elements of one array in FMI 3.0.

Vectors among parameters, start values, states and their derivatives are arrays. Inputs and outputs are
scalars, element by element: each may be connected to another participant, and of the tools of FMI 3.0 that
read all outputs some stop at arrays.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby

from ..variable_layout import Variable


@dataclass(frozen=True)
class ArrayVariable:
    """A variable of FMI 3.0: a scalar, or an array of one dimension with its elements; alike but for their
    names, references and start values."""

    name: str
    elements: tuple[Variable, ...]
    array: bool

    @property
    def first(self) -> Variable:
        """The scalar, or the element whose reference is that of the array."""
        return self.elements[0]


def group_arrays(variables: Iterable[Variable]) -> list[ArrayVariable]:
    """The variables of FMI 3.0, in the same order."""
    return [
        ArrayVariable(name, tuple(elements), array)
        for (name, array), elements in groupby(variables, _split_array)
    ]


def _split_array(variable: Variable) -> tuple[str, bool]:
    """The name of the array and whether it is one."""
    if not variable.size or variable.causality in ("input", "output"):
        return variable.name, False
    return re.sub(r"\[\d+\]", "", variable.name), True
