"""A train over speed: summary of designs, map of a load over angle and speed, Campbell diagram."""

import math
import textwrap
from collections.abc import Mapping
from typing import Any

import matplotlib
import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from models.core.quantities import Vector

from ..assessment.friction.losses import describe_content
from ..assessment.lost_contact import bound_speeds, find_lost, find_unsteady
from .style import (
    ACCENT,
    COUPLED,
    MUTED,
    REFERENCE,
    RPM,
    add_legend_above,
    create_grid,
    create_subplots,
    list_handles,
)

COLOURS = (COUPLED, REFERENCE, ACCENT, MUTED)
MOST_ORDERS = 24
PALE = 0.3  # opacity of speeds at which contact is lost
# Speeds that make a curve.
LEAST_SHOWN = 3
# The least range of a panel, as a share of its values: what changes less is level.
LEAST_RANGE = 0.02
# Natural frequencies of equal trains agree within this share, and are one.
ONE = 1e-3
TORQUE, FILM, ROLLING = "Drive torque (N m)", "Least film (µm)", ".rolling_power"
# Powers of rolling are drawn from this part of the largest power on. Films that differ by more than a factor
# have a logarithmic axis.
COUNTS, APART = 0.02, 10.0
# Of a line of a remark, over the height of its panel.
LINE_HEIGHT = 0.06
# Letters of 6 points in the width of a panel.
LINE = 70
# Title, unit with its factor, endings of results: a panel for each that the table has.
PANELS = (
    ("Contact load (N)", 1.0, (".least_load", ".largest_load")),
    ("Spring margin (%)", 100.0, (".spring_margin",)),
    ("Surge force (N)", 1.0, (".surge_force",)),
    ("Seating velocity (m/s)", 1.0, (".seating_velocity",)),
    (FILM, 1e6, (".least_film",)),
    ("Film over roughness", 1.0, (".least_film_ratio", ".nose_film_ratio")),
    ("Pressure (MPa)", 1e-6, (".peak_pressure", ".nose_pressure")),
    (TORQUE, 1.0, (".least_torque", ".largest_torque", ".mean_torque")),
    ("Friction power (W)", 1.0, (".friction_power", ROLLING)),
    ("Largest lift (mm)", 1e3, (".largest_lift",)),
    ("Travel left to coil bind (mm)", 1e3, (".least_gap",)),
    ("Clearance to the piston (mm)", 1e3, (".least_clearance",)),
    ("Chamber pressure (MPa)", 1e-6, (".chamber_pressure",)),
    ("Adjuster in a turn (µm)", 1e6, (".shortening", ".lift_loss", ".leak_down", ".held_open")),
    ("Largest twist (°)", math.degrees(1.0), (".largest_twist",)),
)


def draw_summary(
    tables: Mapping[str, xarray.Dataset], separations: Mapping[str, float | None] | None = None
) -> Figure:
    """The numbers of all cycles over speed, scaled by those with contact; of a second design dashed.

    Shaded from the speed (r/min) at which a design loses contact, if `separations` have it; curves may leave
    the frame there.
    """
    shown = []
    for title, scale, endings in PANELS:
        every = dict.fromkeys(
            str(n) for t in tables.values() for n in t.data_vars if str(n).endswith(endings)
        )
        if names := drop_small([n for n in every if any(has_values(t, n) for t in tables.values())], tables):
            shown.append((title, scale, names))
    lost = any(find_lost(table).any() for table in tables.values())
    title = " and ".join(tables) + (" (dashed)" if len(tables) > 1 else " over speed")
    title += "; shaded where contact is lost: there curves may leave the frame" * lost
    title += "; open points: no steady cycle" * any(find_unsteady(table).size for table in tables.values())
    figure, panels = create_panels(len(shown), title)
    for panel, (title, scale, names) in zip(panels, shown, strict=True):
        for table, line in zip(tables.values(), ("solid", "dashed"), strict=False):
            _draw_curves(panel, scale, names, table, line)
        limit_to_contact(panel, scale, names, tables)
        for design, table in tables.items():
            shade_lost(panel, table, (separations or {}).get(design))
        panel.set_ylabel(title)
        if title == TORQUE:
            _write_below(panel, _describe_torques(tables))
    return figure


def _write_below(axes: Axes, text: str) -> None:
    """In the panel, under its curves."""
    low, high = axes.get_ylim()
    axes.set_ylim(low - LINE_HEIGHT * (1 + text.count("\n")) * (high - low), high)
    box = {"facecolor": "white", "alpha": 0.8, "lw": 0.0, "pad": 1.0}
    axes.text(0.02, 0.02, text, transform=axes.transAxes, fontsize=6.0, color="0.35", bbox=box)


def drop_small(names: list[str], tables: Mapping[str, xarray.Dataset]) -> list[str]:
    """Without rolling that is little beside the panel's largest value."""
    every = {name: [t[name].values for t in tables.values() if name in t] for name in names}
    reach = {name: max(np.abs(np.nan_to_num(one)).max() for one in every[name]) for name in names}
    least = COUNTS * max(reach.values(), default=0.0)
    return [name for name in names if not name.endswith(ROLLING) or reach[name] > least]


def _describe_torques(tables: Mapping[str, xarray.Dataset]) -> str:
    """Lines that say which friction the torques contain; of each design its own, if they differ."""
    said = {name: describe_content(table.attrs["outside"]) for name, table in tables.items()}
    several = len(set(said.values())) > 1
    texts = [f"{name}: {text}" for name, text in said.items()] if several else list(said.values())[:1]
    return "\n".join(textwrap.fill(text, LINE) for text in texts)


def create_panels(count: int, title: str, below: float = 0.0) -> tuple[Figure, list[Axes]]:
    """A figure with so many panels over speed, three in a row, and room `below` them (inches)."""
    figure, panels = create_grid(count, 3, title, (11.0, 2.6), below, sharex=True)
    for panel in panels:
        panel.ticklabel_format(axis="y", useOffset=False)
    for panel in panels[-3:]:
        panel.set_xlabel("Speed (r/min)")
    return figure, panels


def limit_to_contact(
    axes: Axes, scale: float, names: list[str], tables: Mapping[str, xarray.Dataset]
) -> None:
    """Scale a panel by the speeds with contact: impacts after separation hide all else, and so would a scale
    of what hardly changes. Of films that are far apart the scale is logarithmic."""
    kept = [
        scale * table[name].values[_shown_speeds(table)]
        for table in tables.values()
        for name in names
        if name in table
    ]
    values = np.concatenate(kept)
    values = values[np.isfinite(values)]
    largest = [float(np.nanmax(one)) for one in kept if np.isfinite(one).any()]
    if names[0].endswith(".least_film") and values.min() > 0.0 and max(largest) > APART * min(largest):
        axes.set_yscale("log")
        axes.set_ylim(0.7 * values.min(), 1.4 * values.max())
    elif values.size and np.ptp(values) > 0.0:
        middle = 0.5 * (values.min() + values.max())
        half = 0.65 * max(np.ptp(values), LEAST_RANGE * abs(middle))
        axes.set_ylim(middle - half, middle + half)


def _shown_speeds(table: xarray.Dataset) -> NDArray[np.bool_]:
    """The speeds at which no contact is lost, or all where these are too few for a curve."""
    every = np.ones(table.sizes["speed"], dtype=np.bool_)
    kept = ~find_lost(table)
    return kept if np.count_nonzero(kept) >= LEAST_SHOWN else every


def has_values(table: xarray.Dataset, name: str) -> bool:
    """Whether the result is there, and not zero at all speeds."""
    return name in table and bool(np.any(np.nan_to_num(table[name].values) != 0.0))


def _draw_curves(axes: Axes, scale: float, names: list[str], table: xarray.Dataset, line: str) -> None:
    for i, name in enumerate(names):
        if name in table:
            text = name.replace("_", " ").replace(".", ": ")
            label = None if text in axes.get_legend_handles_labels()[1] else text
            plot_over_speed(axes, table, name, scale, color=COLOURS[i % len(COLOURS)], ls=line, label=label)
    legend = axes.legend(
        loc="lower left", fontsize=6.5, ncols=2, columnspacing=1.0, handlelength=1.4, borderaxespad=0.0
    )
    legend.set_bbox_to_anchor((-0.02, 1.0), transform=axes.transAxes)


def plot_over_speed(axes: Axes, table: xarray.Dataset, name: str, scale: float, **style: Any) -> None:
    """A curve with its points, open ones of cycles that are not steady; none is drawn from a speed with
    contact to one at which it is lost."""
    lost = find_lost(table)
    breaks = np.flatnonzero(lost[1:] != lost[:-1]) + 1
    rpm, values = (
        np.insert(one, breaks, np.nan) for one in (RPM * table["speed"].values, scale * table[name].values)
    )
    (line,) = axes.plot(rpm, values, marker=".", ms=3.0, **style)
    if (unsteady := find_unsteady(table)).size:
        at = scale * table[name].sel(speed=unsteady).values
        axes.plot(RPM * unsteady, at, "o", ms=5.0, mfc="white", mec=line.get_color(), mew=0.8)


def shade_lost(axes: Axes, table: xarray.Dataset, separation: float | None) -> None:
    """From the separation, which is marked, or half-way between computed speeds."""
    rpm, lost = RPM * table["speed"].values, find_lost(table)
    edges = bound_speeds(rpm, separation)
    for low, high, one in zip(edges[:-1], edges[1:], lost, strict=True):
        if one:
            axes.axvspan(low, high, color=MUTED, alpha=0.2, lw=0.0)
    if separation:
        axes.axvline(separation, color=MUTED, lw=1.0, ls=(0, (3, 2)))


def draw_map(cycles: xarray.Dataset, name: str, lost: NDArray[np.bool_]) -> Figure:
    """A load over cam angle and speed; white where it is zero, pale at speeds (rad/s) at which contact is
    `lost`: there cycles are no steady motions, and impacts follow one another."""
    figure, axes = create_subplots(1, 1, f"{name} (N)", (7.6, 5.0))
    degrees = np.degrees(cycles["cam_angle"].values)
    degrees -= 360.0 * np.floor(degrees[:, :1] / 360.0)
    load = cycles[name].values
    rpm = np.broadcast_to(RPM * cycles["speed"].values[:, None], load.shape)
    # Impacts after separation would hide all else.
    largest = float(np.max(load if lost.all() else load[~lost]))
    drawn = axes.pcolormesh(
        degrees,
        rpm,
        np.ma.masked_less_equal(load, 0.0),
        shading="nearest",
        cmap="viridis",
        vmin=0.0,
        vmax=largest,
        alpha=np.broadcast_to(np.where(lost, PALE, 1.0)[:, None], load.shape),
    )
    figure.colorbar(drawn, ax=axes, extend="max" if load.max() > largest else "neither")
    axes.set_xlabel("Cam angle (°)")
    axes.set_ylabel("Speed (r/min)")
    axes.set_ylim(rpm.min(), rpm.max())
    axes.grid(visible=False)
    return figure


def draw_campbell(cycles: xarray.Dataset, name: str) -> Figure:
    """Campbell diagram: a load's orders at their frequencies over speed, and the natural frequencies."""
    title = f"Campbell diagram of {name}: amplitude (N) of the numbered orders"
    figure, axes = create_subplots(1, 1, title, (7.6, 5.0))
    orders, amplitude = find_orders(cycles[name])
    rpm, turns = RPM * cycles["speed"].values, find_cam_speeds(cycles) / (2.0 * math.pi)
    for order in orders:
        axes.plot(rpm, order * turns, color=MUTED, lw=0.4, zorder=1)
        place = (rpm[-1] + 0.012 * np.ptp(rpm), order * turns[-1])
        axes.text(*place, f"{order}", fontsize=6.5, va="center", color="0.35")
    axes.set_xlim(rpm[0] - 0.02 * np.ptp(rpm), rpm[-1] + 0.05 * np.ptp(rpm))
    drawn = axes.scatter(
        np.repeat(rpm, orders.size), np.outer(turns, orders), c=amplitude, s=14, cmap="viridis",
        norm=_scale(amplitude), zorder=2,
    )  # fmt: skip
    figure.colorbar(drawn, ax=axes, extend="min")
    for k, (frequency, _, state) in enumerate(list_oscillations(cycles)):
        if frequency < MOST_ORDERS * turns[-1]:
            axes.axhline(frequency, color=f"C{k % 10}", ls="--", lw=1.2, label=state, zorder=3)
    _add_legend(axes)
    axes.set_xlabel("Speed (r/min)")
    axes.set_ylabel("Frequency (Hz)")
    return figure


def find_orders(load: xarray.DataArray) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The lowest orders of the cam, whose turn is the cycle, and their amplitudes at each speed."""
    values = load.values[:, :-1]
    amplitude = 2.0 * np.abs(np.fft.rfft(values, axis=1)) / values.shape[1]
    return np.arange(1, MOST_ORDERS + 1), amplitude[:, 1 : MOST_ORDERS + 1]


def find_cam_speeds(cycles: xarray.Dataset) -> Vector:
    """Of the cam (rad/s)."""
    return np.asarray(cycles["speed"].values * cycles.attrs["cam_ratio"])


def list_oscillations(cycles: xarray.Dataset) -> list[tuple[float, float, str]]:
    """Natural frequency (Hz), damping ratio and the state that takes most part; equal frequencies once."""
    names = "natural_frequencies", "damping_ratios", "moving_states"
    columns = (np.atleast_1d(cycles.attrs.get(name, [])) for name in names)
    found = [(float(hz), float(ratio), str(state)) for hz, ratio, state in zip(*columns, strict=True)]
    before = [0.0, *(hz for hz, _, _ in found)]
    return [one for one, last in zip(found, before, strict=False) if one[0] > (1.0 + ONE) * last]


def _scale(amplitude: NDArray[np.float64]) -> LogNorm:
    largest = float(amplitude.max()) or 1.0  # of a contact that nothing closes
    return LogNorm(1e-4 * largest, largest)


def _add_legend(axes: Axes) -> None:
    """Each label once, above the axes."""
    if found := list_handles([axes]):
        add_legend_above(axes, len(found), handles=found.values(), labels=found.keys())


# Line styles of results that share a panel, by the beginning of their names; others are solid.
STYLES: dict[str, Any] = {
    "least": "dashed", "mean": "dotted", "largest": "solid", "rolling": "dashdot",
    "nose": (0.0, (3.0, 1.0, 1.0, 1.0, 1.0, 1.0)),
}  # fmt: skip
# Widths of the first design's curves and the last one's, which leave each other to be seen where they agree.
WIDEST, NARROWEST = 3.0, 1.0
# So many designs have shades of one scale; more have hues.
SHADES = 5


def draw_variants(tables: Mapping[str, xarray.Dataset]) -> Figure:
    """The numbers of all cycles over speed, of the first part that has each, scaled by those with contact."""
    shown = []
    for title, scale, endings in PANELS:
        first = filter(None, (_find_first(tables, ending) for ending in endings))
        if names := drop_small([n for n in first if any(has_values(t, n) for t in tables.values())], tables):
            shown.append((title, scale, names))
    lost = any(find_lost(table).any() for table in tables.values())
    title = "Designs over speed" + "; shaded where one loses contact" * lost
    title += "; open points: no steady cycle" * any(find_unsteady(table).size for table in tables.values())
    figure, panels = create_panels(len(shown), title, below=0.4)
    shades = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, len(tables)))
    colours = shades if len(tables) <= SHADES else matplotlib.colormaps["tab20"](np.arange(len(tables)) % 20)
    widths = np.linspace(WIDEST, NARROWEST, len(tables)) if len(tables) > 1 else [NARROWEST]
    used: set[str] = set()
    for panel, (title, scale, names) in zip(panels, shown, strict=True):
        drawn = {name: name.partition(".")[2].partition("_")[0] for name in names} if len(names) > 1 else {}
        used.update(drawn.values())
        for colour, width, table in zip(colours, widths, tables.values(), strict=True):
            for name in names:
                if name in table:
                    style = STYLES.get(drawn.get(name, ""), "solid")
                    plot_over_speed(panel, table, name, scale, color=colour, lw=width, ls=style)
            shade_lost(panel, table, None)
        limit_to_contact(panel, scale, names, tables)
        panel.set_title(f"{title}: {names[0].partition('.')[0]}")
    lines = [Line2D([], [], color=c, label=label) for c, label in zip(colours, tables, strict=True)]
    lines += [
        Line2D([], [], color=MUTED, ls=style, label=word) for word, style in STYLES.items() if word in used
    ]
    figure.legend(handles=lines, loc="outside lower center", ncols=min(4, len(lines)))
    return figure


def _find_first(tables: Mapping[str, xarray.Dataset], ending: str) -> str:
    """The result of the first part that has it, contacts before others; "" for none."""
    every = list(dict.fromkeys(str(name) for table in tables.values() for name in table.data_vars))
    names = [name for name in every if name.endswith(ending)]
    return min(names, key=lambda name: f"{name.partition('.')[0]}.lost" not in every, default="")
