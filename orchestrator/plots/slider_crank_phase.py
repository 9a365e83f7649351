"""Phase portrait of the slider-crank's deviation: flights and slides, and between them the impacts."""

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from .data import FigureData
from .style import COUPLED, MUTED, add_legend_above, create_subplots


def applies(data: FigureData) -> bool:
    return bool(data.all("psi") and data.all("psi_rate"))


def draw(data: FigureData) -> Figure:
    psi = data.all("psi")[0]
    instance = psi.split(".")[0]
    x, y = 1e3 * data.coupled[psi], data.coupled[f"{instance}.psi_rate"]
    # An impact lies between two records where their number has grown.
    hit = np.diff(data.coupled.get(f"{instance}.impact_count", np.zeros_like(x))) > 0.0
    figure, ax = create_subplots(1, 1, f"{data.title}: phase portrait", (5.6, 4.4))
    points = np.column_stack((x, y))
    jumps = list(np.stack((points[:-1][hit], points[1:][hit]), axis=1))
    ax.add_collection(LineCollection(jumps, colors=MUTED, lw=0.5, alpha=0.45))
    for piece in np.split(points, np.flatnonzero(hit) + 1):
        ax.plot(piece[:, 0], piece[:, 1], color=COUPLED, lw=0.8, solid_capstyle="round")
    ax.set_xlabel("Deviation ψ (mrad)")
    ax.set_ylabel("Rate of ψ (rad/s)")
    if hit.any():
        ax.plot([], [], color=COUPLED, lw=0.8, label="motion")
        ax.plot([], [], color=MUTED, lw=0.8, label="impacts")
        add_legend_above(ax)
    return figure
