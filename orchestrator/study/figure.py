"""Results of a study over its one or two axes: curves, or maps where both axes have many values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.core.quantities import Vector

from ..plots.data import SYMBOLS
from ..plots.style import add_title, create_subplots
from ..scenario.units import to_unit

MOST_CURVES = 6  # that can be told apart in one panel


def figure(found: xarray.Dataset, names: Sequence[str]) -> Figure:
    """A panel for each of the results of a store whose points are a grid with one or two axes."""
    x, *other = sorted(found[names[0]].dims, key=lambda name: (_numeric(found[name]), found[name].size))[::-1]
    maps = bool(other) and _numeric(found[other[0]]) and found[other[0]].size > MOST_CURVES
    height = 3.0 if maps else 2.1
    made, panels = create_subplots(
        len(names), 1, sharex=True, squeeze=False, figsize=(6.8, 0.9 + height * len(names))
    )
    add_title(made, found.attrs["title"])
    for axes, name in zip(panels[:, 0], names, strict=True):
        values = found[name].transpose(*other, x)
        if maps:
            _draw_map(made, axes, values, found[x], found[other[0]])
        else:
            _draw_curves(axes, values, found[x], found[other[0]] if other else None)
    panels[-1, 0].set_xlabel(_label(found[x]))
    if other and not maps:
        panels[0, 0].legend(
            title=_label(found[other[0]]), loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=MOST_CURVES,
            borderaxespad=0.2,
        )  # fmt: skip
    return made


def _draw_curves(
    axes: Axes, values: xarray.DataArray, x: xarray.DataArray, other: xarray.DataArray | None
) -> None:
    """One for each value of the other axis; a failed point is a gap."""
    factor, _ = _choose_unit(values)
    rows = np.atleast_2d(factor * values.values)
    labels = [""] if other is None else [_text(value) for value in _values(other)]
    for row, label in zip(rows, labels, strict=True):
        axes.plot(_places(x), row, marker="o", ms=3.0, label=label)
    axes.set_ylabel(_label(values, _name(values)))
    _scale(axes.set_xscale, x)
    if not _numeric(x):
        axes.set_xticks(range(x.size), [_text(value) for value in x.values])


def _draw_map(
    made: Figure, axes: Axes, values: xarray.DataArray, x: xarray.DataArray, y: xarray.DataArray
) -> None:
    factor, _ = _choose_unit(values)
    axes.grid(False)
    mesh = axes.pcolormesh(
        _places(x), _places(y), np.ma.masked_invalid(factor * values.values), shading="nearest",
        rasterized=True,
    )  # fmt: skip
    made.colorbar(mesh, ax=axes, pad=0.02, label=_label(values, _name(values)))
    axes.set_ylabel(_label(y))
    _scale(axes.set_xscale, x)
    _scale(axes.set_yscale, y)


def _numeric(axis: xarray.DataArray) -> bool:
    return axis.dtype.kind in "fiu"


def _values(axis: xarray.DataArray) -> Any:
    return _choose_unit(axis)[0] * axis.values if _numeric(axis) else axis.values


def _places(axis: xarray.DataArray) -> Vector:
    """Where the axis's values stand: at their size, or one after the other."""
    return np.asarray(_values(axis) if _numeric(axis) else np.arange(axis.size), dtype=np.float64)


def _scale(set_scale: Any, axis: xarray.DataArray) -> None:
    """Logarithmic where the axis is spaced so."""
    places = _places(axis)
    if axis.size > 2 and places.min() > 0.0 and _numeric(axis):
        steps, ratios = np.diff(places), np.diff(np.log(places))
        if np.ptp(ratios) < 1e-6 * abs(ratios[0]) and np.ptp(steps) > 1e-6 * abs(steps[0]):
            set_scale("log")


def _choose_unit(values: xarray.DataArray) -> tuple[float, str]:
    """Factor to the unit in which the values are shown, and that unit."""
    unit, shown = values.attrs.get("units", "1"), values.attrs.get("display_units", "")
    factor = 1.0 / to_unit(f"1 {shown}", unit) if shown else 1.0
    return factor, SYMBOLS.get(shown or unit, (shown or unit).replace(".", " "))


def _label(values: xarray.DataArray, name: str = "") -> str:
    """Name, or description, with unit."""
    words = str(name or values.attrs.get("long_name") or values.name)
    unit = _choose_unit(values)[1]
    return words if unit in ("", "1") else f"{words} ({unit})"


def _name(values: xarray.DataArray) -> str:
    """Of a result, in two lines where it is long: contact.load, maximum."""
    variable, dot, statistic = str(values.name).rpartition(".")
    return f"{variable}\n{statistic}" if dot else statistic


def _text(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
