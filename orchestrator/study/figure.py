"""Results of a study over its one or two axes: curves, or maps where both axes have many values."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.core.quantities import Vector

from ..plots.style import create_subplots
from ..scenario.display import show_attributes

MOST_CURVES = 6  # that can be told apart in one panel


def draw_figure(found: xarray.Dataset, names: Sequence[str]) -> Figure:
    """A panel for each of the results of a store whose points are a grid with one or two axes."""
    axes = [found[name] for name in found[names[0]].dims]
    # Along x the longest axis of numbers.
    x, *other = sorted(axes, key=lambda axis: (_is_numeric(axis), axis.size))[::-1]
    maps = bool(other) and _is_numeric(other[0]) and other[0].size > MOST_CURVES
    height = 3.0 if maps else 2.1
    title = found.attrs["title"]
    size = (6.8, 0.9 + height * len(names))
    figure, panels = create_subplots(len(names), 1, title, size, sharex=True, squeeze=False)
    for panel, name in zip(panels[:, 0], names, strict=True):
        values = found[name].transpose(*(axis.name for axis in (*other, x)))
        if maps:
            _draw_map(figure, panel, values, x, other[0])
        else:
            _draw_curves(panel, values, x, other[0] if other else None)
    panels[-1, 0].set_xlabel(_format_label(x))
    if other and not maps:
        panels[0, 0].legend(
            title=_format_label(other[0]), loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=MOST_CURVES,
            borderaxespad=0.2,
        )  # fmt: skip
    return figure


def _draw_curves(
    axes: Axes, values: xarray.DataArray, x: xarray.DataArray, other: xarray.DataArray | None
) -> None:
    """Draw a curve for each value of the other axis; a failed point is a gap."""
    factor, _ = _choose_unit(values)
    rows = np.atleast_2d(factor * values.values)
    labels = [""] if other is None else [_format_value(value) for value in _convert_values(other)]
    for row, label in zip(rows, labels, strict=True):
        axes.plot(_find_places(x), row, marker="o", ms=3.0, label=label)
    axes.set_ylabel(_format_label(values, _format_name(values)))
    _set_scale(axes.set_xscale, x)
    if not _is_numeric(x):
        axes.set_xticks(range(x.size), [_format_value(value) for value in x.values])


def _draw_map(
    figure: Figure, axes: Axes, values: xarray.DataArray, x: xarray.DataArray, y: xarray.DataArray
) -> None:
    factor, _ = _choose_unit(values)
    axes.grid(False)
    mesh = axes.pcolormesh(
        _find_places(x), _find_places(y), np.ma.masked_invalid(factor * values.values), shading="nearest",
        rasterized=True,
    )  # fmt: skip
    figure.colorbar(mesh, ax=axes, pad=0.02, label=_format_label(values, _format_name(values)))
    axes.set_ylabel(_format_label(y))
    _set_scale(axes.set_xscale, x)
    _set_scale(axes.set_yscale, y)


def _is_numeric(axis: xarray.DataArray) -> bool:
    return axis.dtype.kind in "fiu"


def _convert_values(axis: xarray.DataArray) -> Any:
    return _choose_unit(axis)[0] * axis.values if _is_numeric(axis) else axis.values


def _find_places(axis: xarray.DataArray) -> Vector:
    """Coordinates of the axis's values: numbers at their value, names at 0, 1, 2..."""
    return np.asarray(_convert_values(axis) if _is_numeric(axis) else np.arange(axis.size), dtype=np.float64)


def _set_scale(set_scale: Any, axis: xarray.DataArray) -> None:
    """Use a logarithmic scale for an axis with equal ratios."""
    places = _find_places(axis)
    if axis.size > 2 and places.min() > 0.0 and _is_numeric(axis):
        steps, ratios = np.diff(places), np.diff(np.log(places))
        if np.ptp(ratios) < 1e-6 * abs(ratios[0]) and np.ptp(steps) > 1e-6 * abs(steps[0]):
            set_scale("log")


def _choose_unit(values: xarray.DataArray) -> tuple[float, str]:
    """Factor to the display unit, and that unit."""
    shown = show_attributes(values.attrs)
    return shown.factor, shown.symbol


def _format_label(values: xarray.DataArray, name: str = "") -> str:
    """Name, or description, with unit."""
    words = str(name or values.attrs.get("long_name") or values.name)
    unit = _choose_unit(values)[1]
    return words if unit in ("", "1") else f"{words} ({unit})"


def _format_name(values: xarray.DataArray) -> str:
    """A result's name in two lines: variable, statistic."""
    variable, dot, statistic = str(values.name).rpartition(".")
    return f"{variable}\n{statistic}" if dot else statistic


def _format_value(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
