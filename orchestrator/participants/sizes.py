"""Structural parameters of FMI 3.0, and the arrays whose sizes follow from them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

STRUCTURAL = "structuralParameter"


def resize(found: Any, sizes: Mapping[str, int]) -> None:
    """Give fmpy's description these values of structural parameters, and arrays the shapes that follow."""
    if not sizes:
        return
    for variable in found.modelVariables:
        if variable.causality == STRUCTURAL and variable.name in sizes:
            variable.start = str(sizes[variable.name])
    for variable in found.modelVariables:
        variable.shape = tuple(
            int(d.variable.start if d.start is None else d.start) for d in variable.dimensions
        )
    found.numberOfContinuousStates = _count(found.derivatives)
    found.numberOfEventIndicators = _count(found.eventIndicators)


def _count(unknowns: Any) -> int:
    return sum(math.prod(unknown.variable.shape) for unknown in unknowns)
