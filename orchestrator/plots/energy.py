"""What the coupling created over each power bond, and what components got outside of bonds, over time.

A panel for each bond with the larger part, in joules; the title says how much went over it.
"""

import numpy as np
from matplotlib.figure import Figure

from ..scenario.display import SYMBOLS
from ..scenario.units import choose_time_unit
from .data import FigureData
from .style import ACCENT, COUPLED, MUTED, create_subplots

# Bonds with less than this share of the largest created energy cannot be seen beside it.
SHOWN = 1e-6


def applies(data: FigureData) -> bool:
    return bool(find_bonds(data))


def find_bonds(data: FigureData) -> list[str]:
    """The bonds of the ledger over which the coupling created energy."""
    prefix = "created "
    largest = {
        name.removeprefix(prefix): float(np.abs(values).max(initial=0.0))
        for name, values in data.energies.items()
        if name.startswith(prefix)
    }
    most = max(largest.values(), default=0.0)
    return [name for name, size in largest.items() if size > SHOWN * most]


def draw(data: FigureData) -> Figure:
    names = find_bonds(data)
    rows = len(names) + 1
    title = f"{data.title}: energy created by the coupling"
    figure, axes = create_subplots(rows, 1, title, (6.8, 0.9 + 1.5 * rows), sharex=True, squeeze=False)
    unit, factor = choose_time_unit(float(np.ptp(data.energy_time)))
    time = factor * data.energy_time
    for ax, name in zip(axes[:, 0], names, strict=False):
        created, given = data.energies[f"created {name}"], data.energies[f"given {name}"]
        ax.plot(time, created, color=COUPLED)
        exchanged = float(np.abs(np.diff(given)).sum())
        ax.set_title(f"{name}: {exchanged:.3g} J exchanged", loc="left", fontsize=8.5)
    last = axes[-1, 0]
    last.plot(time, data.energies["created"], color=COUPLED, label="over all bonds")
    last.plot(time, data.energies["outside_bonds"], color=ACCENT, label="outside bonds")
    last.set_title("All together", loc="left", fontsize=8.5)
    last.legend(loc="best", ncols=2)
    last.set_xlabel(f"Time ({SYMBOLS.get(unit, unit)})")
    last.set_xlim(time[0], time[-1])
    for ax in axes[:, 0]:
        ax.axhline(0.0, color=MUTED, lw=0.7)
        ax.ticklabel_format(axis="y", style="sci", scilimits=(-2, 3))
        ax.set_ylabel("Energy (J)")
    return figure
