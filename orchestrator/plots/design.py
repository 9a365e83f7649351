"""A designed cam beside the one that the scenario has: lift and derivatives, contour, loads and pressures."""

import json
import math
from collections.abc import Sequence

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from .style import COUPLED, MUTED, REFERENCE, RPM, create_subplots

COLOURS = {"before": MUTED, "after": COUPLED}


def draw_design(table: xarray.Dataset) -> Figure:
    """Kinematics on the left, the cam and its contacts on the right, each at the speed where it is worst."""
    sizes, speed = json.loads(table.attrs["limits"]), float(table.attrs["cam_speed"])
    contacts = [str(n).removesuffix(".load") for n in table.data_vars if str(n).endswith(".load")]
    contact = contacts[0]
    figure, axes = create_subplots(4, 2, str(table.attrs["title"]), (10.0, 9.6), sharex=True)
    degrees = np.degrees(table["angle"].values)
    square, cube = speed**2, speed**3
    shaft, top = table.attrs["shaft"], float(table.attrs["top_speed"])
    at = f"at {top * RPM:.0f} r/min of {shaft}"
    left: Sequence[tuple[str, float, str, list[float]]] = (
        ("lift", 1e3, "Lift (mm)", [1e3 * sizes["largest_lift"]] if "largest_lift" in sizes else []),
        ("slope", speed, f"Velocity (m/s)\n{at}", _both(sizes, "largest_velocity")),
        ("acceleration", square, f"Acceleration (m/s²)\n{at}", _range(sizes)),
        ("jerk", 1e-3 * cube, f"Jerk (km/s³)\n{at}", [1e-3 * size for size in _both(sizes, "largest_jerk")]),
    )
    for panel, (name, factor, label, lines) in zip(axes[:, 0], left, strict=True):
        _plot(panel, degrees, factor * table[name].values, label, lines)
    curved = [1.0 / sizes["least_radius"]] if "least_radius" in sizes else []
    curved += [-1.0 / sizes["wheel_radius"]] if sizes.get("wheel_radius", math.inf) < 10.0 else []
    _plot(axes[0, 1], degrees, table["curvature"].values, "Curvature of the cam (1/m)", curved)
    worst: dict[str, float] = json.loads(table.attrs["worst"])
    right: Sequence[tuple[str, float, str, list[float]]] = (
        ("load", 1.0, f"Load of {contact} (N)", [sizes["least_load"]] if "least_load" in sizes else []),
        (
            "maximum_pressure", 1e-6, "Hertz pressure (MPa)",
            [1e-6 * sizes[f"{contact}.maximum_pressure"]] if f"{contact}.maximum_pressure" in sizes else [],
        ),
        ("film_ratio", 1.0, "Film over roughness", [one for one in [sizes["film_ratio"]] if one]),
    )  # fmt: skip
    for panel, (name, factor, label, lines) in zip(axes[1:, 1], right, strict=True):
        values = factor * table[f"{contact}.{name}"].sel(speed=worst[name]).values
        at = f"at {worst[name] * RPM:.0f} r/min of {shaft}"
        _plot(panel, degrees, np.where(np.isfinite(values), values, np.nan), f"{label}\n{at}", lines)
    lifted = table["lift"].values.max(axis=0) > 1e-3 * table["lift"].values.max()
    for panel in axes[-1]:
        panel.set_xlabel("Cam angle (°)")
        panel.set_xlim(degrees[lifted].min() - 5.0, degrees[lifted].max() + 5.0)
        panel.xaxis.set_major_locator(MultipleLocator(30.0))
    axes[0, 1].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3)
    return figure


def _both(sizes: dict[str, float], name: str) -> list[float]:
    return [sizes[name], -sizes[name]] if name in sizes else []


def _range(sizes: dict[str, float]) -> list[float]:
    ends = (("largest_acceleration", 1.0), ("largest_deceleration", -1.0))
    return [sign * sizes[name] for name, sign in ends if name in sizes]


def _plot(axes: Axes, degrees: np.ndarray, curves: np.ndarray, label: str, lines: list[float]) -> None:
    for (name, colour), curve in zip(COLOURS.items(), curves, strict=True):
        axes.plot(degrees, curve, color=colour, label=name, lw=1.6 if name == "after" else 1.2)
    for i, line in enumerate(lines):
        axes.axhline(line, color=REFERENCE, lw=0.9, ls="--", label="limit" if not i else None)
    axes.set_ylabel(label)
