"""Load and film thickness of loaded contacts against the reference, with their errors below.

A column for each contact, over the angle of the shaft that drives it; of many, those with the largest errors
of the load. Shaded, and without film, where the contact carries no load. Films are scaled by the last turn
of several: the film of the start, which the scenario gives, may be many times thicker.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .data import FigureData
from .style import ACCENT, create_subplots, label_abscissa, plot_both, shade, write_remark

# Contacts side by side at most.
COLUMNS = 4
# Of a shaft (deg), less what rounding leaves of two.
TURN = 359.0
VARIABLES = {"load": "Load", "film_thickness": "Film thickness"}


def applies(data: FigureData) -> bool:
    return bool(data.reference) and bool(find_loaded_contacts(data))


def list_instances(data: FigureData) -> set[str]:
    """All contacts, loaded or not."""
    return set(data.having("film_thickness"))


def find_loaded_contacts(data: FigureData) -> list[str]:
    """Contacts that carry load at some time in either run."""
    return [
        name
        for name in data.having("film_thickness")
        if any(np.any(values.get(f"{name}.load", 0.0)) for values in (data.coupled, data.reference))
    ]


def draw(data: FigureData) -> Figure:
    loaded = find_loaded_contacts(data)
    names = loaded[:COLUMNS]
    if len(loaded) > COLUMNS:
        largest = sorted(loaded, key=lambda name: -float(np.nanmax(np.abs(data.error(f"{name}.load")))))
        names = [name for name in loaded if name in largest[:COLUMNS]]
    width = 6.8 if len(names) == 1 else 0.8 + 4.6 * len(names)
    which = f" of {len(names)} of {len(loaded)} contacts, the largest" if len(loaded) > COLUMNS else ""
    figure, axes = create_subplots(
        4, len(names), f"{data.title}: load and film, with their errors{which}", (width, 7.0),
        sharex="col", squeeze=False, height_ratios=(3, 2, 3, 2),
    )  # fmt: skip
    for column, name in zip(axes.T, names, strict=True):
        own = data.of(name).in_contact(name)
        for row, (variable, words) in enumerate(VARIABLES.items()):
            above = column[2 * row]
            plot_both(above, own, f"{name}.{variable}", words)
            top = _find_top(own, f"{name}.{variable}") if variable == "film_thickness" else None
            above.set_ylim(-0.05 * top if top else min(0.0, above.get_ylim()[0]), top)
            factor, unit = own.shown(f"{name}.{variable}")
            if top and (most := factor * float(np.nanmax(own.coupled[f"{name}.{variable}"]))) > top:
                write_remark(above, f"before the last revolution up to {most:.3g} {unit}")
            _draw_error(column[2 * row + 1], own, f"{name}.{variable}")
        for ax in column:
            shade(ax, own, name)
        label_abscissa(column[-1], own)
        column[0].set_title(name.replace("_", " ") if len(names) > 1 else "", loc="left")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _find_top(data: FigureData, name: str) -> float | None:
    """For the last turn of several; None where the whole run has to be seen."""
    x = data.x()
    if not data.abscissa()[0] or x[-1] - x[0] < 2.0 * TURN:
        return None
    values = data.shown(name)[0] * data.coupled[name][x > x[-1] - TURN]
    largest = float(np.max(values, initial=0.0, where=np.isfinite(values)))
    return 1.1 * largest if largest > 0.0 else None


def _draw_error(ax: Axes, data: FigureData, name: str) -> None:
    factor, unit = data.shown(name)
    error = factor * data.error(name)
    finite = np.abs(error[np.isfinite(error)])
    ax.plot(data.x(True), error, color=ACCENT, lw=0.8)
    ax.axhline(0.0, color="0.4", lw=0.7)
    top = 1.1 * float(finite.max(initial=0.0)) or 1.0
    ax.set_ylim(-top, top)
    ax.ticklabel_format(axis="y", style="sci", scilimits=(-2, 3))
    ax.set_ylabel(f"Error ({unit})")
