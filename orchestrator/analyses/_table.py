"""Tables with units, and the `evaluate` of an analysis from its table."""

import functools
from collections.abc import Callable, Mapping
from typing import Any

import xarray


def column(dimensions: str | tuple[str, ...], values: Any, unit: str, meaning: str) -> xarray.Variable:
    """A variable of a table."""
    return xarray.Variable(dimensions, values, {"units": unit, "long_name": meaning})


def evaluate_by(
    table: Callable[[Mapping[str, Any]], xarray.Dataset],
) -> Callable[[Mapping[str, Any]], dict[str, float | str]]:
    """The `evaluate` of an analysis whose results are the variables without dimension of its table."""

    @functools.wraps(table)
    def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
        found = table(values).data_vars.items()
        return {str(name): variable.item() for name, variable in found if not variable.ndim}

    return evaluate
