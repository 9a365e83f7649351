"""Tables with units, and `evaluate` and `draw` of an analysis from its table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

import xarray

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def column(dimensions: str | tuple[str, ...], values: Any, unit: str, meaning: str) -> xarray.Variable:
    """A variable of a table."""
    return xarray.Variable(dimensions, values, {"units": unit, "long_name": meaning})


def evaluate_by(
    table: Callable[[Mapping[str, Any]], xarray.Dataset],
) -> Callable[[Mapping[str, Any]], dict[str, float | str]]:
    """The `evaluate` of an analysis whose results are the variables without dimension of its table."""

    def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
        found = table(values).data_vars.items()
        return {str(name): variable.item() for name, variable in found if not variable.ndim}

    return evaluate


def draw_by(module: str, function: str) -> Callable[[xarray.Dataset, Mapping[str, Any]], Figure]:
    """The `draw` of an analysis: a function in `plots`, imported on the first call."""

    def draw(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
        figure: Figure = getattr(import_module(f"orchestrator.plots.{module}"), function)(data, values)
        return figure

    return draw
