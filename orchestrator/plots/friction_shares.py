"""Friction torque of a whole train over speed: its shares in each design, and the sums of all designs."""

import math
from collections.abc import Mapping, Sequence
from typing import Protocol

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from models.core.quantities import Vector

from ..assessment.friction.shares import SHARES
from .style import add_title, create_subplots

COLUMNS = 3


class Torques(Protocol):
    """Speeds (r/min), torques (N m) by share and their sum, of a design."""

    @property
    def design(self) -> str: ...
    @property
    def speeds(self) -> Vector: ...
    @property
    def torques(self) -> Mapping[str, Vector]: ...
    @property
    def total(self) -> Vector: ...


def draw_shares(designs: Sequence[Torques], title: str) -> Figure:
    count = len(designs) + (len(designs) > 1)
    columns = 2 if count == 4 else min(COLUMNS, count)
    rows = math.ceil(count / columns)
    size = (max(6.0, 3.6 * columns), 3.0 * rows + 0.8)
    figure, axes = create_subplots(rows, columns, figsize=size, squeeze=False, sharex=True, sharey=True)
    add_title(figure, f"{title}: friction torque on the drive over speed")
    panels = list(axes.flat)
    for panel in panels[count:]:
        panel.remove()
    shares = [share for share in SHARES if any(share in one.torques for one in designs)]
    hues = matplotlib.colormaps["tab10"](np.arange(len(SHARES)))
    colours = {share: hues[SHARES.index(share)] for share in shares}
    for panel, one in zip(panels, designs, strict=False):
        panel.set_title(one.design, loc="left")
        layers = [1e3 * one.torques[share] for share in shares]
        panel.stackplot(one.speeds, layers, colors=list(colours.values()), labels=shares, alpha=0.85)
        panel.plot(one.speeds, 1e3 * one.total, color="black", lw=1.0)
    if len(designs) > 1:
        sums = panels[len(designs)]
        sums.set_title("sums", loc="left")
        shades = matplotlib.colormaps["plasma"](np.linspace(0.0, 0.85, len(designs)))
        for shade, one in zip(shades, designs, strict=True):
            sums.plot(one.speeds, 1e3 * one.total, color=shade, marker="o", ms=3.0, label=one.design)
        sums.legend(loc="best", fontsize=7.5)
    for i, panel in enumerate(panels[:count]):
        panel.set_xlabel("Speed (r/min)")
        panel.tick_params(labelbottom=True)
        panel.set_ylim(bottom=0.0)
        if i % columns == 0:
            panel.set_ylabel("Torque (mN m)")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(5, len(labels)))
    return figure
