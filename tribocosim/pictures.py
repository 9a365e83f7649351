"""Figures that notebooks show."""

import io
from collections.abc import Sequence

import xarray
from matplotlib.figure import Figure

from orchestrator.scenario.display import show_attributes


class Picture(Figure):
    """A figure of matplotlib that a notebook shows, without a window or a backend of its own."""

    def _repr_png_(self) -> bytes:
        file = io.BytesIO()
        self.savefig(file, format="png", dpi=100)
        return file.getvalue()


def draw(
    variables: Sequence[str], over: str, coupled: xarray.Dataset, reference: xarray.Dataset | None
) -> Picture:
    """Each variable, coupled and reference, below each other."""
    figure = Picture(figsize=(8.0, 2.2 * len(variables) + 0.6), layout="constrained")
    grid = figure.subplots(len(variables), sharex=True, squeeze=False)
    along = show_attributes(coupled[over].attrs)
    for axes, name in zip(grid[:, 0], variables, strict=True):
        shown = show_attributes(coupled[name].attrs)
        axes.plot(along.factor * coupled[over], shown.factor * coupled[name], label="coupled")
        if reference is not None and name in reference and over in reference:
            axes.plot(along.factor * reference[over], shown.factor * reference[name], "--", label="reference")
        axes.set_ylabel(f"{name}\n({shown.symbol})" if shown.unit else name)
    if len(variables):
        grid[-1, 0].set_xlabel(f"{over.replace('_', ' ')} ({along.symbol})" if along.unit else over)
        if len(grid[0, 0].lines) > 1:
            figure.legend(
                *grid[0, 0].get_legend_handles_labels(), loc="outside upper right", ncols=2, frameon=False
            )
    return figure
