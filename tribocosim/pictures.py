"""Figures that notebooks show."""

import io
from collections.abc import Sequence

import xarray
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter

# Units that take a prefix as they are: 4 MPa, but not 4 km2 for 4000 m2.
PREFIXED = ("m", "m/s", "m/s2", "rad", "rad/s", "N", "N.m", "Pa", "W", "J")


class Picture(Figure):
    """A figure of matplotlib that a notebook shows, without a window or a backend of its own."""

    def _repr_png_(self) -> bytes:
        file = io.BytesIO()
        self.savefig(file, format="png", dpi=100)
        return file.getvalue()


def draw(variables: Sequence[str], coupled: xarray.Dataset, reference: xarray.Dataset | None) -> Picture:
    """Each variable over time, coupled and reference, below each other."""
    figure = Picture(figsize=(8.0, 2.2 * len(variables) + 0.6), layout="constrained")
    grid = figure.subplots(len(variables), sharex=True, squeeze=False)
    for axes, name in zip(grid[:, 0], variables, strict=True):
        values = coupled[name]
        axes.plot(values["time"], values, label="coupled")
        if reference is not None and name in reference:
            axes.plot(reference["time"], reference[name], "--", label="reference")
        unit = str(values.attrs.get("units", "1"))
        if unit in PREFIXED:
            axes.yaxis.set_major_formatter(EngFormatter(unit))
        axes.set_ylabel(name if unit in (*PREFIXED, "1", "") else f"{name}\n[{unit}]")
    if len(variables):
        grid[-1, 0].set_xlabel("time [s]")
        if len(grid[0, 0].lines) > 1:
            grid[0, 0].legend()
    return figure
