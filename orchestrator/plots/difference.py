"""Error of the judged variables, each in a panel, over the reference's RMS spread, as tolerances count it."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.core.difference import CONSTANT, time_weights
from models.core.quantities import Vector

from .data import FigureData
from .style import ACCENT, COUPLED, create_grid, label_abscissa, list_handles

# Errors below this share of the spread are rounding and not shown.
FLOOR = 1e-15
# Panels at most, and beside one another.
PANELS, COLUMNS = 8, 2
# Points of an envelope.
BINS = 400


def applies(data: FigureData) -> bool:
    return bool(choose_variables(data))


def choose_variables(data: FigureData) -> list[str]:
    """Variables with a tolerance, or else those exchanged, that vary and have an error to be drawn."""
    exchanged = list(dict.fromkeys(data.drivers.values()))
    varying = [
        [
            name
            for name in wanted
            if name in data.reference
            and (spread := compute_spread(data, name)) > 0.0
            and np.any(np.abs(data.error(name)) > FLOOR * spread)
        ]
        for wanted in (data.tolerance, exchanged)
    ]
    return next((names for names in varying if names), [])


def compute_spread(data: FigureData, name: str) -> float:
    """RMS of the reference about its mean; 0 if that is rounding."""
    reference, weights = data.reference[name], time_weights(data.reference_time)
    mean = np.average(reference, weights=weights)
    found = float(np.sqrt(np.average(np.square(reference - mean), weights=weights)))
    return found if found > CONSTANT * float(np.max(np.abs(reference))) else 0.0


def draw(data: FigureData) -> Figure:
    names = choose_variables(data)
    shown = names[:PANELS]
    columns = min(COLUMNS, len(shown))
    size = (6.8, 3.0) if columns == 1 else (10.4, 3.0 if len(shown) <= columns else 2.0)
    what = f"error of {len(shown)} of {len(names)} variables" if len(names) > len(shown) else "error"
    title = f"{data.title}: {what} against the reference"
    figure, panels = create_grid(len(shown), columns, title, size, 1.2, sharey=True)
    hidden = [
        _draw_panel(ax, data.of(name.split(".")[0]), name) for ax, name in zip(panels, shown, strict=True)
    ]
    figure.supylabel("|coupled − reference| / RMS spread of the reference", fontsize=9.0)
    if any(hidden):
        figure.supxlabel(f"Errors below {FLOOR:.0e} are not drawn.", fontsize=8.5, x=0.012, ha="left")
    if handles := list_handles(panels):
        figure.legend(handles.values(), handles.keys(), loc="outside upper right", ncols=2)
    return figure


def _draw_panel(ax: Axes, data: FigureData, name: str) -> bool:
    """Draw one variable's error; return whether some of it is below FLOOR."""
    contact, spread = name.split(".")[0], compute_spread(data, name)
    shown = data.in_contact(contact) if f"{contact}.load" in data.reference else data
    relative = np.abs(shown.error(name)) / spread
    first, top = compute_envelope(np.where(relative > FLOOR, relative, np.nan))
    ax.semilogy(data.x(True)[first], top, color=COUPLED, lw=1.1)
    if name in data.tolerance:
        ax.axhline(data.tolerance[name], color=ACCENT, lw=1.0, ls=(0, (4, 2)), label="allowed as RMS")
    ax.set_title(name, loc="left", fontsize=9.0)
    label_abscissa(ax, data)
    return bool(np.isnan(top).any())


def compute_envelope(values: Vector) -> tuple[Any, Vector]:
    """First index and largest value of each bin; dips at changes of sign would hide the line."""
    if len(values) <= 2 * BINS:
        return np.arange(len(values)), values
    first = np.arange(BINS) * len(values) // BINS
    return first, np.fmax.reduceat(values, first)
