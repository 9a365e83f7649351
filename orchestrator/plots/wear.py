"""A cam that wears: depth over the cam angle and over the cycles, and what its contact bears."""

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from .style import ACCENT, COUPLED, REFERENCE, create_subplots

# Ages that are drawn at most.
SHOWN = 6


def draw_wear(table: xarray.Dataset) -> Figure:
    """The ages of a table of `tribocosim wear`; cycles are those by the largest wear coefficient."""
    figure, ((profile, life), (pressure, film)) = create_subplots(2, 2, str(table.attrs["title"]), (9.6, 6.0))
    deepest = 1e3 * table["deepest"].values
    fewest, most = table["fewest_cycles"].values, table["most_cycles"].values
    for age in select_ages(deepest):
        part = deepest[age] / deepest[-1]
        words = f"{fewest[age]:.2g}" + (f" to {most[age]:.2g}" if most[age] > fewest[age] else "")
        profile.plot(
            np.degrees(table["angle"].values), 1e3 * table["depth"].values[age],
            color=COUPLED, alpha=0.25 + 0.75 * part, label=words,
        )  # fmt: skip
    profile.set_xlabel("Cam angle (°)")
    profile.set_ylabel("Depth of the cam (mm)")
    profile.set_xlim(60.0, 300.0)
    profile.xaxis.set_major_locator(MultipleLocator(30.0))
    profile.legend(title="cycles", title_fontsize=8.0, fontsize=7.5, ncols=2, loc="upper center")
    finite = np.where(np.isfinite(most), most, fewest)
    depth = np.linspace(0.02 * deepest[-1], deepest[-1])
    ends = [np.interp(depth, deepest, cycles) for cycles in (fewest, finite)]
    life.fill_betweenx(depth, *ends, color=COUPLED, alpha=0.25, lw=0.0)
    for cycles, end in zip((fewest, finite), ends, strict=True):
        life.plot(end, depth, color=COUPLED)
        life.plot(cycles[1:], deepest[1:], ".", color=COUPLED)
    life.set_xscale("log")
    life.set_xlabel("Cycles, between both wear coefficients")
    life.set_ylabel("Deepest wear of the cam (mm)")
    pressure.plot(deepest, 1e-6 * table["peak_pressure"].values, ".-", color=REFERENCE)
    pressure.set_ylabel("Largest pressure (MPa)")
    film.plot(deepest, 1e6 * table["least_film"].values, ".-", color=ACCENT)
    film.set_ylabel("Least film (µm)")
    for ax in (pressure, film):
        ax.set_xlabel("Deepest wear of the cam (mm)")
    for ax in (life, pressure, film):
        ax.set_ylim(0.0, 1.08 * ax.dataLim.y1 or 1.0)
    profile.set_ylim(0.0, 1.45 * deepest[-1])
    return figure


def select_ages(deepest: np.ndarray) -> list[int]:
    """Ages at most SHOWN, spread evenly over their depth."""
    wanted = np.linspace(deepest[min(1, deepest.size - 1)], deepest[-1], SHOWN)
    return sorted({int(np.abs(deepest - depth).argmin()) for depth in wanted})
