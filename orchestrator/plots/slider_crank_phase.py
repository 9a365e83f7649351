"""Phase portrait of the slider-crank's deviation: flights and slides, and between them the impacts."""

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from models.core.quantities import Vector

from .data import FigureData
from .style import COUPLED, MUTED, add_title, create_subplots


def applies(data: FigureData) -> bool:
    return data.find("psi") is not None and data.find("psi_rate") is not None


def draw(data: FigureData) -> Figure:
    psi = str(data.find("psi"))
    instance = psi.split(".")[0]
    x, y = 1e3 * data.coupled[psi], data.coupled[f"{instance}.psi_rate"]
    hit = find_impacts(data.coupled.get(f"{instance}.impact_count", np.zeros_like(x)))
    figure, ax = create_subplots(figsize=(5.6, 4.4))
    add_title(figure, f"{data.title}: phase portrait")
    points = np.column_stack((x, y))
    ax.add_collection(
        LineCollection(
            list(np.stack((points[:-1][hit], points[1:][hit]), axis=1)), colors=MUTED, lw=0.5, alpha=0.45
        )
    )
    for piece in np.split(points, np.flatnonzero(hit) + 1):
        ax.plot(piece[:, 0], piece[:, 1], color=COUPLED, lw=0.8, solid_capstyle="round")
    ax.set_xlabel("Deviation ψ (mrad)")
    ax.set_ylabel("Rate of ψ (rad/s)")
    if hit.any():
        ax.plot([], [], color=COUPLED, lw=0.8, label="motion")
        ax.plot([], [], color=MUTED, lw=0.8, label="impacts")
        ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
    return figure


def find_impacts(count: Vector) -> np.ndarray:
    """Whether there was an impact between each record and the next, from the number of impacts so far."""
    return np.diff(count) > 0.0
