"""psi over crank angle."""

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
    from ..plots.motion.titles import legend, titled
    from ..plots.motion.trace import draw_trace

    figure, axes = titled("Time trace", values, width=6.8, height=3.0)
    columns = (data[name].values for name in ("theta", "psi", "side", "upper", "lower"))
    draw_trace(axes, *columns)
    legend(figure, axes)
    return figure


ANALYSIS = Analysis(
    name="trace",
    description="Time trace: the rod's deviation over crank angle, between its walls",
    parameters=PARAMETERS,
    results=RESULTS,
    evaluate=evaluate,
    table=table,
    draw=draw,
)
