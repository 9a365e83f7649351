"""Poincaré map of impacts on one wall."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from models.core.quantities import Vector
from models.slider_crank.flight.bouncing import LOWER, UPPER

from ..plots.motion import create_figure, set_angle_axis
from ..plots.style import COUPLED, REFERENCE
from ._distribution import COUNTS, count_impacts, simulate_first_impacts
from ._machine import MACHINE, START, column, declare_duration
from .protocol import Parameter, Result, declare


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    impacts, cycles = simulate_first_impacts(values)
    chosen = impacts.where(impacts.side == (UPPER if values["wall"] == "upper" else LOWER))
    return xarray.Dataset(
        {
            "cycle": column("impact", chosen.cycle, "1", "crank cycle since the start"),
            "theta": column("impact", chosen.theta, "rad", "crank angle"),
            "psi_rate": column("impact", chosen.rate, "1", "psi' before the impact, per crank angle"),
            "approach": column("impact", chosen.approach, "1", "velocity towards the wall, over l Omega"),
            "onset": column("impact", chosen.kind, "1", "1: sliding begins"),
            "points": chosen.theta.size,
            "seen": cycles,
            **count_impacts(impacts, cycles),
        }
    )


# Parts of the height and the width that can be told apart.
RASTER = 1000.0
# Crank angles low and high, psi' low and high.
Window = tuple[float, float, float, float]


def draw_poincare(
    axes: Axes,
    theta: Vector,
    rate: Vector,
    window: Window | None = None,
    marks: Sequence[Window] = (),
    label: bool = True,
) -> None:
    """Points in the window (default: the whole revolution); `marks`: windows to outline."""
    if window is not None:
        inside = (theta >= window[0]) & (theta <= window[1]) & (rate >= window[2]) & (rate <= window[3])
        theta, rate = theta[inside], rate[inside]
    axes.scatter(theta, rate, s=choose_dot_size(theta, rate), color=COUPLED, linewidths=0.0, rasterized=True)
    if window is None:
        set_angle_axis(axes)
        axes.margins(y=0.04)
    else:
        axes.set_xlim(window[0], window[1])
        axes.set_ylim(window[2], window[3])
        axes.locator_params(nbins=5)
    for mark in marks:
        corner, width, height = (mark[0], mark[2]), mark[1] - mark[0], mark[3] - mark[2]
        axes.add_patch(Rectangle(corner, width, height, fill=False, ec=REFERENCE, lw=1.0, zorder=3))
    if label:
        axes.set_xlabel("crank angle θ (rad)")
        axes.set_ylabel("ψ′ before impact")


def choose_dot_size(theta: Vector, rate: Vector) -> float:
    """Area of a dot (points squared): single points are seen, many do not run into each other."""
    height = float(np.ptp(rate)) if rate.size else 0.0
    places = np.stack([theta / (2.0 * math.pi), rate / (height or 1.0)])
    apart = np.unique(np.round(RASTER * places), axis=1).shape[1]
    return float(np.clip(3000.0 / max(apart, 1), 0.15, 6.0))


def magnify(theta: Vector, rate: Vector, centre: tuple[float, float], by: float) -> Window:
    """The window `by` times smaller than the whole, around the point nearest to `centre`."""
    width = 2.0 * math.pi
    height = float(np.ptp(rate)) or 1.0
    distances = ((theta - centre[0]) / width) ** 2 + ((rate - centre[1]) / height) ** 2
    i = int(np.argmin(distances))
    half = (0.5 * width / by, 0.5 * height / by)
    return theta[i] - half[0], theta[i] + half[0], rate[i] - half[1], rate[i] + half[1]


def plot_poincare(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    theta, rate = data["theta"].values, data["psi_rate"].values
    if not theta.size:
        figure, axes = create_figure(f"Poincaré map, {values['wall']} wall: no impacts", values, 6.0, 4.0)
        draw_poincare(axes, theta, rate)
        return figure
    figure, axes = create_figure(
        f"Poincaré map, {values['wall']} wall", values, 9.6, 4.4,
        mosaic=[["all", "all", "first"], ["all", "all", "second"]],
    )  # fmt: skip
    centre, by = (values["centre_angle"], values["centre_rate"]), values["magnification"]
    first, second = (magnify(theta, rate, centre, factor) for factor in (by, by * by))
    draw_poincare(axes["all"], theta, rate, marks=[first])
    draw_poincare(axes["first"], theta, rate, first, marks=[second], label=False)
    draw_poincare(axes["second"], theta, rate, second, label=False)
    for name, factor in (("first", by), ("second", by * by)):
        axes[name].set_title(f"× {factor:g}", fontsize=9, loc="left")
    return figure


ANALYSIS = declare(
    name="poincare",
    description="Poincaré map: impacts on one wall, velocity over crank angle, magnified twice (F 3.5)",
    parameters={
        **MACHINE,
        **START,
        **declare_duration(40_000, 200),
        "most": Parameter(400_000, "1", "impacts after which it ends early", minimum=1.0, integer=True),
        "wall": Parameter("upper", "1", "wall", choices=("upper", "lower")),
        "centre_angle": Parameter(
            1.0, "rad", "magnified: around the impact nearest to it", minimum=0.0, maximum=2.0 * math.pi
        ),
        "centre_rate": Parameter(0.06, "1", "and to this psi'"),
        "magnification": Parameter(6.0, "1", "of the first window, and of the second over it", minimum=1.0),
    },
    results={
        "points": Result("1", "impacts on this wall"),
        "seen": Result("1", "crank cycles that they took"),
        **COUNTS,
    },
    table=build_table,
    draw=plot_poincare,
)
