"""Friction, its torque, film ratio and wear over a cam revolution, and the wear along the follower."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from ..assessment.friction.cycle import TURN, Cycle, Wear
from .solved_film import FULL
from .style import ACCENT, COUPLED, MUTED, REFERENCE, add_legend_above, create_subplots, widen_zero


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
        widen_zero(ax)
        ax.set_ylim(bottom=0.0)
    add_legend_above(force, 3)
    return figure
