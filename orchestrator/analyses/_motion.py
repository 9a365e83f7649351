"""Time trace and phase portrait: one table, two figures."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray

from models.slider_crank.motions.portrait import trace_portrait

from ..plots.motion.phase import plot_phase
from ..plots.motion.trace import plot_trace
from ._machine import MACHINE, START, declare_duration, simulate_motion
from ._table import column, evaluate_by
from .protocol import Analysis, Draw, Parameter, Result

PARAMETERS = {
    **MACHINE,
    **START,
    **declare_duration(3, 200),
    "points": Parameter(1000, "1", "equally spaced points a revolution", minimum=2.0, integer=True),
}
RESULTS = {
    "impacts_per_cycle": Result("1", "impacts per crank cycle"),
    "sliding_share": Result("1", "part of the time that the slider slides"),
    "largest_rate": Result("1", "largest |psi'|"),
}


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    """Points of the motion, those before and after each impact included."""
    motion = simulate_motion(values)
    found = trace_portrait(motion, values["cycles"], values["points"])
    widths = np.diff(found.theta)
    theta = column("point", found.theta, "rad", "crank angle since the start; equal twice at an impact")
    return xarray.Dataset(
        {
            "psi": column("point", found.psi, "rad", "deviation of the rod"),
            "psi_rate": column("point", found.psi_rate, "1", "its derivative by crank angle"),
            "side": column("point", found.side, "1", "wall on which it slides: 1 upper, -1 lower, 0 flight"),
            "upper": column("point", found.upper, "rad", "psi at the upper wall"),
            "lower": column("point", found.lower, "rad", "psi at the lower wall"),
            "impacts_per_cycle": np.count_nonzero(widths == 0.0) / values["cycles"],
            "sliding_share": float(widths[found.side[:-1] != 0.0].sum() / widths.sum()),
            "largest_rate": float(abs(found.psi_rate).max()),
        },
        coords={"theta": theta},
    )


def _declare(name: str, description: str, draw: Draw) -> Analysis:
    return Analysis(
        name=name,
        description=description,
        parameters=PARAMETERS,
        results=RESULTS,
        evaluate=evaluate_by(build_table),
        table=build_table,
        draw=draw,
    )


PHASE = _declare("phase", "Phase portrait: rate over deviation, cut at impacts", plot_phase)
TRACE = _declare("trace", "Time trace: the rod's deviation over crank angle, between its walls", plot_trace)
