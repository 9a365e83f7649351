"""Iterations of the macro steps, where the master iterates."""

from __future__ import annotations

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from .data import FigureData
from .style import COUPLED, plt


def applies(data: FigureData) -> bool:
    return data.iterations.size > 0 and bool(data.iterations.max() > 1)


def figure(data: FigureData) -> Figure:
    made, (over, counts) = plt.subplots(
        1, 2, figsize=(6.8, 2.6), sharey=True, gridspec_kw={"width_ratios": [4, 1]}
    )
    made.suptitle(
        f"{data.title}: iterations of each macro step", x=0.012, ha="left", fontsize=11, fontweight="bold"
    )
    over.plot(1e3 * data.step_time, data.iterations, ".", ms=2.0, color=COUPLED, rasterized=True)
    over.set_xlabel("Time (ms)")
    over.set_ylabel("Iterations")
    over.set_ylim(0.0, 1.1 * data.iterations.max())
    over.yaxis.set_major_locator(MaxNLocator(integer=True))
    last = int(data.iterations.max())
    edges = [i - 0.5 for i in range(1, last + 2)]
    share = [100.0 / data.iterations.size] * data.iterations.size
    counts.hist(
        data.iterations, bins=edges, weights=share, orientation="horizontal", color=COUPLED, rwidth=0.8
    )
    counts.set_xlabel("Share of steps (%)")
    return made
