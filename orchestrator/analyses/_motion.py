"""Time trace and phase portrait: one table, two figures."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from models.slider_crank.motions.portrait import trace_portrait

from ..plots.motion import MILLI, add_legend, create_figure, draw_phase, set_angle_axis, shift_to_first_turn
from ..plots.style import ACCENT, COUPLED, MUTED
from ._machine import MACHINE, START, column, declare_duration, simulate_motion
from .protocol import Analysis, Draw, Parameter, Result, declare

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


def plot_trace(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """Walls dashed, sliding in another colour."""
    figure, axes = create_figure("Time trace", values, width=6.8, height=3.0)
    angle, psi, side = shift_to_first_turn(data["theta"].values), data["psi"].values, data["side"].values
    for wall, words in (("upper", "walls"), ("lower", None)):
        axes.plot(angle, MILLI * data[wall].values, color=MUTED, lw=0.9, ls=(0, (5, 3)), label=words)
    axes.plot(angle, MILLI * psi, color=COUPLED, lw=1.0, label="flight")
    if np.any(side != 0.0):
        sliding = np.where(side != 0.0, MILLI * psi, np.nan)
        axes.plot(angle, sliding, color=ACCENT, lw=2.4, solid_capstyle="butt", label="sliding")
    set_angle_axis(axes, angle[0], 2.0 * np.pi * np.ceil(angle[-1] / (2.0 * np.pi)))
    axes.margins(y=0.08)
    axes.set_ylabel("ψ (mrad)")
    add_legend(figure, axes)
    return figure


def plot_phase(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    figure, axes = create_figure("Phase portrait", values, width=5.2, height=4.2)
    theta, psi, rate, side = (data[name].values for name in ("theta", "psi", "psi_rate", "side"))
    wall = data["upper"].values
    impacts = np.flatnonzero(np.diff(theta) == 0.0) + 1
    draw_phase(axes, psi, rate, impacts, np.abs(side) > 0.0, walls=(float(wall.min()), float(wall.max())))
    return figure


def _declare(name: str, description: str, draw: Draw) -> Analysis:
    return declare(
        name=name,
        description=description,
        parameters=PARAMETERS,
        results=RESULTS,
        table=build_table,
        draw=draw,
    )


PHASE = _declare("phase", "Phase portrait: rate over deviation, cut at impacts", plot_phase)
TRACE = _declare("trace", "Time trace: the rod's deviation over crank angle, between its walls", plot_trace)
