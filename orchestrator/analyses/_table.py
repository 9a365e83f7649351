"""Tables with units."""

from __future__ import annotations

from typing import Any

import xarray


def column(dimensions: str | tuple[str, ...], values: Any, unit: str, meaning: str) -> xarray.Variable:
    """A variable of a table."""
    return xarray.Variable(dimensions, values, {"units": unit, "long_name": meaning})


def scalars(table: xarray.Dataset) -> dict[str, float | str]:
    """The results in a table: its variables without dimension."""
    return {str(name): variable.item() for name, variable in table.data_vars.items() if not variable.ndim}
