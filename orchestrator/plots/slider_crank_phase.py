"""Phase portrait of the slider-crank's deviation."""

from __future__ import annotations

from matplotlib.figure import Figure

from .data import FigureData
from .style import COUPLED, plt


def applies(data: FigureData) -> bool:
    return data.find("psi") is not None and data.find("psi_rate") is not None


def figure(data: FigureData) -> Figure:
    psi, rate = str(data.find("psi")), str(data.find("psi_rate"))
    made, ax = plt.subplots(figsize=(5.2, 4.4))
    made.suptitle(f"{data.title}: phase portrait", x=0.012, ha="left", fontsize=11, fontweight="bold")
    ax.plot(1e3 * data.coupled[psi], data.coupled[rate], color=COUPLED, lw=0.6)
    ax.set_xlabel("Deviation ψ (mrad)")
    ax.set_ylabel("Rate of ψ (rad/s)")
    return made
