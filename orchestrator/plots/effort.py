"""Iterations of the macro steps, where the master iterates."""

from __future__ import annotations

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from .data import FigureData
from .style import COUPLED, headed, plt


def applies(data: FigureData) -> bool:
    return data.iterations.size > 0 and bool(data.iterations.max() > 1)


def figure(data: FigureData) -> Figure:
    made, (over, counts) = plt.subplots(
        1, 2, figsize=(6.8, 2.6), sharey=True, gridspec_kw={"width_ratios": [4, 1]}
    )
    headed(made, f"{data.title}: iterations of each macro step")
    over.plot(1e3 * data.step_time, data.iterations, ".", ms=2.0, color=COUPLED, rasterized=True)
    over.set_xlabel("Time (ms)")
    over.set_ylabel("Iterations")
    last = int(data.iterations.max())
    over.set_xlim(0.0, 1e3 * data.step_time[-1])
    over.set_ylim(0.0, last + 0.6)
    over.yaxis.set_major_locator(MaxNLocator(integer=True))
    edges = [i - 0.5 for i in range(1, last + 2)]
    share = [100.0 / data.iterations.size] * data.iterations.size
    counts.hist(
        data.iterations, bins=edges, weights=share, orientation="horizontal", color=COUPLED, rwidth=0.8
    )
    counts.set_xlabel("Share of steps (%)")
    return made
