"""Phase portrait."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ._motion import PARAMETERS, RESULTS, table
from ._table import scalars
from .protocol import Analysis

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure


def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
    return scalars(table(values))


def draw(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    from ..plots.motion.phase import draw_phase
    from ..plots.motion.titles import titled

    figure, axes = titled("Phase portrait", values, width=5.2, height=4.2)
    columns = (data[name].values for name in ("theta", "psi", "psi_rate", "side"))
    wall = data["upper"].values
    draw_phase(axes, *columns, walls=(float(wall.min()), float(wall.max())))
    return figure


ANALYSIS = Analysis(
    name="phase",
    description="Phase portrait: rate over deviation, cut at impacts",
    parameters=PARAMETERS,
    results=RESULTS,
    evaluate=evaluate,
    table=table,
    draw=draw,
)
