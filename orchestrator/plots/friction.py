"""Friction, its torque, film ratio and wear over a cam revolution, and the wear along the follower."""

from collections.abc import Mapping, Sequence
from typing import Protocol

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from models.core.quantities import Vector

from ..assessment.friction.cycle import TURN, Cycle, Wear
from ..assessment.friction.losses import SHARES
from .solved_film import FULL
from .style import ACCENT, COUPLED, MUTED, REFERENCE, add_legend_above, create_grid, create_subplots


def draw_friction(cycle: Cycle, worn: Wear, cycles: float, title: str) -> Figure:
    title = f"{title}, {cycle.contact}: friction and wear over a cam revolution"
    figure, axes = create_subplots(5, 1, title, (6.8, 8.6))
    angle = np.degrees(cycle["cam_angle"] - TURN * np.floor(cycle["cam_angle"][0] / TURN + 1e-9))
    force, torque, ratio, cam, follower = axes
    force.plot(angle, cycle["friction_force"], color=COUPLED, label="friction")
    force.plot(angle, cycle["boundary_friction"], color=REFERENCE, label="of asperities")
    force.set_ylabel("Friction (N)")
    torque.plot(angle, cycle.torque, color=COUPLED)
    torque.set_ylabel("Torque (N m)")
    ratio.plot(angle, np.where(cycle["load"] > 0.0, cycle["film_ratio"], np.nan), color=ACCENT)
    ratio.axhline(FULL, color=MUTED, lw=0.7)
    ratio.text(
        0.995, FULL, f"full film above {FULL:g}", transform=ratio.get_yaxis_transform(), ha="right",
        va="bottom", fontsize=7.0, color=MUTED,
    )  # fmt: skip
    ratio.set_ylabel("Film ratio")
    cam.plot(np.degrees(worn.cam_angle), 1e6 * cycles * worn.cam_depth, color=COUPLED)
    cam.set_ylabel(f"Cam wear (µm)\nafter {cycles:g}\nrevolutions")
    cam.set_xlabel("Cam angle (°)")
    for ax in (force, torque, ratio):
        if cycle.lost.any():
            ax.fill_between(
                angle, 0.0, 1.0, where=cycle.lost, color=MUTED, alpha=0.25, lw=0.0, label="contact lost",
                transform=ax.get_xaxis_transform(),
            )  # fmt: skip
        ax.sharex(cam)
        ax.tick_params(labelbottom=False)
    cam.set_xlim(0.0, 360.0)
    cam.xaxis.set_major_locator(MultipleLocator(45.0))
    follower.plot(1e3 * worn.follower_place, 1e6 * cycles * worn.follower_depth, color=COUPLED)
    follower.set_ylabel(f"Follower wear (µm)\nafter {cycles:g}\nrevolutions")
    follower.set_xlabel("Place along the follower (mm)")
    for ax in axes:
        ax.set_ylim(bottom=0.0)
    add_legend_above(force, 3)
    return figure


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
    title = f"{title}: friction torque on the drive over speed"
    size = (max(6.0, 3.6 * columns), 3.0)
    figure, panels = create_grid(count, columns, title, size, 0.8, sharex=True, sharey=True)
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
    for i, panel in enumerate(panels):
        panel.set_xlabel("Speed (r/min)")
        panel.set_ylim(bottom=0.0)
        if i % columns == 0:
            panel.set_ylabel("Torque (mN m)")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(5, len(labels)))
    return figure
