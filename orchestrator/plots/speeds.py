"""A train over speed: summary, map of a load over angle and speed, and its orders."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from .style import ACCENT, COUPLED, MUTED, REFERENCE, add_title, create_subplots

RPM = 30.0 / math.pi
COLOURS = (COUPLED, REFERENCE, ACCENT, MUTED)
MOST_ORDERS = 24
# Title, unit with its factor, endings of results: a panel for each that the table has.
PANELS = (
    ("Contact load (N)", 1.0, (".least_load", ".largest_load")),
    ("Spring margin (1)", 1.0, (".spring_margin",)),
    ("Surge force (N)", 1.0, (".surge_force",)),
    ("Landing velocity (m/s)", 1.0, (".seating_velocity",)),
    ("Least film (µm)", 1e6, (".least_film",)),
    ("Largest pressure (MPa)", 1e-6, (".peak_pressure",)),
    ("Drive torque (N m)", 1.0, (".least_torque", ".largest_torque", ".mean_torque")),
    ("Friction power (W)", 1.0, (".friction_power",)),
    ("Largest lift (mm)", 1e3, (".largest_lift",)),
    ("Largest twist (°)", math.degrees(1.0), (".largest_twist",)),
)


def draw_summary(tables: Mapping[str, xarray.Dataset]) -> Figure:
    """The numbers of all cycles over speed; of a second design in dashed lines."""
    shown = []
    for title, scale, endings in PANELS:
        every = dict.fromkeys(
            str(n) for t in tables.values() for n in t.data_vars if str(n).endswith(endings)
        )
        if names := [n for n in every if any(_has_values(table, n) for table in tables.values())]:
            shown.append((title, scale, names))
    rows = math.ceil(len(shown) / 3)
    figure, axes = create_subplots(rows, 3, figsize=(11.0, 2.6 * rows), squeeze=False, sharex=True)
    add_title(figure, " and ".join(tables) + (" (dashed)" if len(tables) > 1 else " over speed"))
    for panel in axes.flat[len(shown) :]:
        panel.remove()
    for panel, (title, scale, names) in zip(axes.flat, shown, strict=False):
        for table, line in zip(tables.values(), ("solid", "dashed"), strict=False):
            _draw_curves(panel, scale, names, table, line)
        panel.set_title(title)
    for panel in axes.flat[max(0, len(shown) - 3) : len(shown)]:
        panel.set_xlabel("Speed (r/min)")
        panel.tick_params(labelbottom=True)
    return figure


def _has_values(table: xarray.Dataset, name: str) -> bool:
    return name in table and bool(np.any(np.nan_to_num(table[name].values) != 0.0))


def _draw_curves(axes: Axes, scale: float, names: list[str], table: xarray.Dataset, line: str) -> None:
    rpm = RPM * table["speed"].values
    for i, name in enumerate(names):
        if name not in table:
            continue
        label = name.replace("_", " ").replace(".", ": ") if line == "solid" else None
        axes.plot(rpm, scale * table[name].values, color=COLOURS[i % len(COLOURS)], ls=line, label=label)
    if len(names) > 1:
        axes.legend(fontsize=7)


def draw_map(cycles: xarray.Dataset, name: str) -> Figure:
    """A load over cam angle and speed; white where it is zero."""
    figure, axes = create_subplots(figsize=(7.6, 5.0))
    add_title(figure, f"{name} (N)")
    degrees = np.degrees(cycles["cam_angle"].values)
    degrees -= 360.0 * np.floor(degrees[:, :1] / 360.0)
    load = cycles[name].values
    rpm = np.broadcast_to(RPM * cycles["speed"].values[:, None], load.shape)
    # Single blows after separation would hide all else.
    largest = float(np.percentile(load, 99.0))
    drawn = axes.pcolormesh(
        degrees,
        rpm,
        np.ma.masked_less_equal(load, 0.0),
        shading="nearest",
        cmap="viridis",
        vmin=0.0,
        vmax=largest,
    )
    figure.colorbar(drawn, ax=axes, extend="max" if load.max() > largest else "neither")
    axes.set_xlabel("Cam angle (°)")
    axes.set_ylabel("Speed (r/min)")
    axes.grid(visible=False)
    return figure


def draw_orders(cycles: xarray.Dataset, name: str) -> Figure:
    """Amplitudes of a load's orders over speed, with the order that meets the spring's surge (Campbell)."""
    figure, axes = create_subplots(figsize=(7.6, 5.0))
    add_title(figure, f"Orders of {name}: amplitude (N)")
    load = cycles[name].values[:, :-1]
    amplitude = 2.0 * np.abs(np.fft.rfft(load, axis=1))[:, 1 : MOST_ORDERS + 1] / load.shape[1]
    rpm = RPM * cycles["speed"].values
    orders = np.arange(1, MOST_ORDERS + 1)
    largest = float(amplitude.max())
    scale = LogNorm(1e-4 * largest, largest)
    drawn = axes.pcolormesh(rpm, orders, amplitude.T, shading="nearest", cmap="viridis", norm=scale)
    figure.colorbar(drawn, ax=axes, extend="min")
    for i, frequency in enumerate(np.atleast_1d(cycles.attrs.get("surge_frequencies", []))):
        label = "surge" if i == 0 else None
        axes.plot(rpm, 60.0 * frequency / (rpm * cycles.attrs["cam_ratio"]), color=REFERENCE, label=label)
        axes.legend(loc="upper right")
    axes.set_ylim(0.5, MOST_ORDERS + 0.5)
    axes.set_xlabel("Speed (r/min)")
    axes.set_ylabel("Order of the cam")
    axes.grid(visible=False)
    return figure
