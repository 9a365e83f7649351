"""What moves a train's figures of merit: bars for the parameters, the longest first."""

import numpy as np
import xarray
from matplotlib.figure import Figure

from .style import COUPLED, REFERENCE, create_grid

# Bars of a panel, and panels in a row.
MOST_BARS, COLUMNS = 8, 2
# An elasticity below this is none.
LEAST = 1e-3


def draw_tornado(dataset: xarray.Dataset, title: str) -> Figure:
    """A panel for each figure: its change in % for 1 % more of each parameter; red where it falls. All panels
    have one scale. The coordinates `shown` and `size` say the values of figures and parameters."""
    title = f"{title}: change in % for 1 % more of a parameter"
    figure, panels = create_grid(dataset.sizes["figure"], COLUMNS, title, (10.0, 2.3), 0.6, sharex=True)
    for panel, name in zip(panels, dataset["figure"].values, strict=True):
        values = np.nan_to_num(dataset["elasticity"].sel(figure=name).values)
        order = np.argsort(-np.abs(values), kind="stable")[:MOST_BARS][::-1]
        colours = [COUPLED if values[k] >= 0.0 else REFERENCE for k in order]
        names = [f"{dataset['parameter'].values[k]}, {dataset['size'].values[k]}" for k in order]
        said = [f"{values[k]:.2g}" if abs(values[k]) >= LEAST else "0" for k in order]
        panel.bar_label(panel.barh(names, values[order], color=colours), said, padding=2, fontsize=7)
        panel.axvline(0.0, color="black", linewidth=0.8)
        panel.grid(axis="y", visible=False)
        part, _, number = str(name).rpartition(".")
        value = dataset["shown"].sel(figure=name).item()
        panel.set_title(f"{part}: {number.replace('_', ' ')}, {value}", loc="right")
        panel.margins(x=0.15)
    return figure
