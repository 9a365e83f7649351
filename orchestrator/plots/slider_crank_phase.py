"""Phase portrait of the slider-crank's deviation, cut at impacts, whose jumps are pale."""

import numpy as np
from matplotlib.figure import Figure

from .data import FigureData
from .motion import draw_phase
from .style import create_subplots


def applies(data: FigureData) -> bool:
    return bool(data.having("psi") and data.having("psi_rate"))


def draw(data: FigureData) -> Figure:
    instance = data.having("psi")[0]
    psi, rate = (data.coupled[f"{instance}.{name}"] for name in ("psi", "psi_rate"))
    # An impact lies between two records where their number has grown.
    counts = data.coupled.get(f"{instance}.impact_count", np.zeros_like(psi))
    figure, axes = create_subplots(1, 1, f"{data.title}: phase portrait, impacts pale", (5.6, 4.4))
    draw_phase(axes, psi, rate, np.flatnonzero(np.diff(counts) > 0.0) + 1)
    axes.set_ylabel("Rate of ψ (rad/s)")
    return figure
