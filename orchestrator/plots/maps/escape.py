"""Part of the motions that have not settled, over cycles, with the exponential fit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from models.slider_crank.motions.transients import ORDINARY_TRANSIENT

from ..motion.titles import add_legend, create_figure
from ..style import COUPLED, REFERENCE


def plot_transient(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has length and period (0: not settled) of every start, mean_escape and its error."""
    figure, axes = create_figure("Length of transients", values, width=6.0, height=3.8)
    after, lengths = ORDINARY_TRANSIENT, data["length"].values
    settled = np.sort(lengths[data["period"].values > 0])
    left = 1.0 - np.arange(len(settled) + 1) / len(lengths)
    axes.step(
        np.concatenate([[0.0], settled, [lengths.max()]]),
        np.append(left, left[-1]),
        where="post", color=COUPLED, label="starts",
    )  # fmt: skip
    mean, error = data["mean_escape"].item(), data["error"].item()
    if np.isfinite(mean):
        t = np.linspace(after, max(lengths.max(), after + 1.0), 200)
        share = np.mean(lengths > after)
        axes.plot(
            t, share * np.exp(-(t - after) / mean), color=REFERENCE, lw=1.0, ls=(0, (5, 3)),
            label=f"exponential, mean {mean:.4g} ± {error:.2g}",
        )  # fmt: skip
    axes.set_yscale("log")
    axes.set_ylim(0.5 / len(lengths), 1.3)
    axes.set_xlim(left=0.0)
    axes.set_xlabel("cycles")
    axes.set_ylabel("part not yet on its orbit")
    add_legend(figure, axes)
    return figure
